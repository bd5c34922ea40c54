"""What a joint carries: its inertia about the axis of the joint, and the pull of its weight."""

import math
from dataclasses import dataclass, replace

import numpy as np

from simgap.errors import InputError
from simgap.robot_files.bodies import Axis, Body, Pose, Robot, Solid

_ANGLE = 1e-3  # rad: what an angle written with three decimals may be wrong by
_LENGTH = 1e-6  # m: a center of mass nearer to the axis than a micrometre is on it


@dataclass(frozen=True)
class Load:
    """What a joint carries, with all other joints at their reference.

    Attributes:
        bodies: how many bodies it moves.
        mass: kg.
        inertia: about the axis, kg·m²; of a sliding joint the mass, kg.
        sine: gravity's torque is −sine·sin(position) − cosine·cos(position), N·m.
        cosine: see `sine`.
        force: of gravity along a sliding joint, N.
    """

    bodies: int
    mass: float
    inertia: float
    sine: float = 0.0
    cosine: float = 0.0
    force: float = 0.0


def load_of(robot: Robot, axis: Axis, body: Body, pose: Pose) -> Load:
    """Return what a joint carries.

    Args:
        robot: with the gravity.
        axis: the joint.
        body: that it moves.
        pose: of the body in the world.

    Raises:
        InputError: when a mass is missing or refused, or nothing has a mass.
    """
    direction, anchor = pose.rotation @ axis.direction, pose.of(axis.anchor)
    mass, moment, inertia, bodies = 0.0, np.zeros(3), 0.0, 0
    for part, place in replace(body, pose=Pose()).walk(pose):
        bodies += 1
        for solid in part.solids():
            arm = place.of(solid.center) - anchor
            mass += solid.mass
            moment += solid.mass * arm
            inertia += _about(direction, arm, solid, place)
    if mass <= 0.0 or (inertia <= 0.0 and not axis.slides):
        what = "mass" if mass <= 0.0 else "inertia about its axis"
        raise InputError(
            f"joint {axis.name!r} moves no {what}", robot.file, "give its bodies masses and inertias"
        )
    if axis.slides:
        return Load(bodies, mass, mass, force=mass * float(robot.gravity @ direction))
    sine, cosine = _gravity(robot.gravity, direction, moment, mass, axis.reference)
    return Load(bodies, mass, inertia, sine, cosine)


def _about(direction: np.ndarray, arm: np.ndarray, solid: Solid, place: Pose) -> float:
    """Return the inertia of a mass about an axis that its center is an arm away from: the parallel axis theorem."""
    along = place.rotation.T @ direction
    return float(along @ solid.inertia @ along + solid.mass * np.sum(np.cross(direction, arm) ** 2))


def _gravity(
    gravity: np.ndarray, direction: np.ndarray, moment: np.ndarray, mass: float, reference: float
) -> tuple[float, float]:
    """Return sine and cosine part of gravity's torque about an axis.

    At an angle φ from hanging, counted about the axis, the torque is −G·sin φ (the pendulum's equation). The file shows
    the joint at its reference, and φ grows with the position.
    """
    across_gravity = gravity - direction * (direction @ gravity)
    arm = moment - direction * (direction @ moment)
    strength, length = float(np.linalg.norm(across_gravity)), float(np.linalg.norm(arm))
    if strength <= _ANGLE * float(np.linalg.norm(gravity)) or length <= _LENGTH * mass:
        return 0.0, 0.0
    hanging = math.atan2(-direction @ np.cross(arm, across_gravity), arm @ across_gravity) - reference
    size = strength * length
    sine, cosine = size * math.cos(hanging), size * math.sin(hanging)
    if abs(cosine) <= _ANGLE * size:
        return math.copysign(size, sine), 0.0
    return (0.0 if abs(sine) <= _ANGLE * size else sine), cosine
