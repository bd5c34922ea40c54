"""One joint of a robot in the keys of a platform."""

import difflib
import math
from typing import Any

from simgap.errors import InputError
from simgap.robot_files.bodies import Axis, Body, Pose, Robot
from simgap.robot_files.load import Load, load_of

_GRAVITY = 9.81  # m/s², of a platform that does not give it


def joint_keys(robot: Robot, name: str | None) -> dict[str, Any]:
    """Return the keys of docs/contract.md for a joint, with what was assumed.

    Args:
        robot: of a file.
        name: of the joint; None for the only one that moves.

    Raises:
        InputError: when there is no such joint, several could be meant, or it moves no mass.
    """
    axis, body, pose = _chosen(robot, name)
    load = load_of(robot, axis, body, pose)
    keys: dict[str, Any] = {"kind": "joint", "inertia": load.inertia + axis.armature}
    if load.sine:
        keys["gravity_torque"] = load.sine
    strength = math.hypot(*robot.gravity)
    if abs(strength - _GRAVITY) > 1e-9:
        keys["gravity"] = strength
    if axis.stiffness:
        keys["stiffness"] = axis.stiffness
    if controller := _controller(axis, keys["inertia"]):
        keys["controller"] = controller
    return keys | {"assumptions": [*_of_load(robot, axis, load), *_unused(axis, load), *axis.remarks]}


def _chosen(robot: Robot, name: str | None) -> tuple[Axis, Body, Pose]:
    found = list(robot.axes())
    names = [axis.name for axis, _, _ in found]
    if name is None and len(found) == 1:
        return found[0]
    if not names:
        raise InputError("has no joint that turns or slides about one axis", robot.file, "give another file")
    if name is None:
        raise InputError(
            f"has {len(names)} joints", robot.file, f"choose one with joint=NAME: {_some(names)}"
        )
    if names.count(name) != 1:
        near = difflib.get_close_matches(name, names, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"use one of {_some(names)}"
        raise InputError(f"there is no joint {name!r} that turns or slides", robot.file, remedy)
    return found[names.index(name)]


def _some(names: list[str]) -> str:
    shown = ", ".join(names[:8])
    return shown if len(names) <= 8 else f"{shown} and {len(names) - 8} more"


def _controller(axis: Axis, inertia: float) -> dict[str, float]:
    """Return the gains at the joint; a damping ratio ζ makes the derivative gain 2·ζ·√(gain·inertia), as in MuJoCo."""
    found = {"effort_limit": axis.effort_limit or 0.0}
    if axis.controller is not None:
        found["proportional"] = axis.controller.proportional
        found["derivative"] = axis.controller.derivative
        if axis.damping_ratio is not None:
            found["derivative"] = 2.0 * axis.damping_ratio * math.sqrt(axis.controller.proportional * inertia)
    return {key: value for key, value in found.items() if value > 0.0}


def _of_load(robot: Robot, axis: Axis, load: Load) -> list[str]:
    bodies = "one body" if load.bodies == 1 else f"{load.bodies} bodies"
    said = [
        f"Joint {axis.name!r} of {robot.file} moves {bodies} of {load.mass:.4g} kg. "
        "The base stands upright, and all other joints are held where the file has them."
    ]
    if axis.armature <= 0.0:
        said.append(
            "The file has no inertia of the rotor: add it to platform.inertia, times the gear ratio squared."
        )
    if load.cosine:
        whole = math.hypot(load.sine, load.cosine)
        shift = math.atan2(load.cosine, load.sine)
        said.append(
            f"At position zero the weight does not hang: its torque is −({load.sine:.4g}·sin(position) + "
            f"{load.cosine:.4g}·cos(position)) N·m, and a platform holds the sine only. Add "
            f"simulator.effects.gravity_load.sine=0 simulator.effects.gravity_load.cosine={load.cosine:.6g}, or add "
            f"{shift:.6g} rad to the recorded position and give platform.gravity_torque={whole:.6g}."
        )
    return said


def _unused(axis: Axis, load: Load) -> list[str]:
    """Return what the file says and a platform cannot hold; a diagnosis may start from it."""
    constant = load.force + axis.stiffness * axis.relaxed
    found = {
        "viscous_friction.coefficient": axis.damping,
        "coulomb_friction.level": axis.friction,
        "constant_load.load": constant,
    }
    return [
        f"The file has a {name.partition('.')[0].replace('_', ' ')} of {value:.4g}, which is not used; "
        f"if you believe it, add simulator.effects.{name}={value:.6g}."
        for name, value in found.items()
        if value
    ]
