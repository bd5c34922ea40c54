"""Typical sizes of a machine at work, by which starting values and bounds of a fit are multiplied.

A friction of 0.1 N·m is large for a finger and nothing for a press. What a fit starts from, and where it stops, must
not depend on that, nor on whether a platform speaks of newtons or kilonewtons, of metres or millimetres. A number in
`Effect.starts` and a bound of a `Parameter` are therefore those of a machine whose typical effort, travel, speed and
current are 1. For a recorded machine they are multiplied by its own sizes, each to the power with which it enters the
parameter's unit.

A joint's sizes are in units, and follow from its recording. Those of a quadrotor and of a swerve drive follow from its
platform file, in multiples of a machine of the size for which the catalogue's numbers hold: the racer of
`conf/platform/racer.yaml` and the robot of `conf/platform/swerve_robot.yaml`. A rotor of a palm-sized quadrotor has a
hundredth of a racer's inertia.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from torch import Tensor

from simgap.physics.servo import servo_effort
from simgap.physics.shapes import Signals

_PEAK_TO_PEAK = 2.0 * 2.0**0.5  # of a sine, over its standard deviation; outliers hardly change that
_LEAST = 1e-30  # smaller is no size: a signal that is always zero

POWERS: Mapping[str, Mapping[str, int]] = {
    "N·m": {"effort": 1},
    "N·m/rad": {"effort": 1, "travel": -1},
    "N·m/rad³": {"effort": 1, "travel": -3},
    "N·m·s/rad": {"effort": 1, "speed": -1},
    "N·m·s²/rad²": {"effort": 1, "speed": -2},
    "rad": {"travel": 1},
    "1/rad": {"travel": -1},
    "rad/s": {"speed": 1},
    "A": {"current": 1},
    "H": {"resistance": 1},  # a time constant times the resistance
}
"""Sizes in a joint parameter's unit; another unit has none: a ratio, a time, a voltage, a temperature."""

_IN_MACHINES: Mapping[str, Mapping[str, int]] = {
    "m": {"reach": 1},
    "m²": {"reach": 2},
    "N·m": {"torque": 1},
    "N·m/rad": {"torque": 1},
    "N·s": {"torque": 1},
    "N·m·s/rad": {"torque": 1},
    "kg·m²": {"torque": 1, "turning": -1},
}
"""As `POWERS`, for machines whose sizes are multiples. Speeds of flight and of turning are alike for all."""


def sizes_of(kind: str, signals: Signals, constants: Mapping[str, Any]) -> dict[str, float]:
    """Return the sizes of a machine that its recording shows, by name; those that it does not show are absent.

    Args:
        kind: of the platform.
        signals: recorded, (blocks, samples).
        constants: of the platform; without them the effort of a voltage is unknown, and a machine has no sizes.
    """
    if kind == "joint":
        return _joint(signals, constants)
    if not constants:
        return {}
    own, usual = _OF_PLATFORM[kind](constants), _USUAL[kind]
    return {name: size / usual[name] for name, size in own.items()}


def size_of(unit: str, sizes: Mapping[str, float]) -> float:
    """Return the factor on a number in a unit; 1 for what the recording does not show."""
    return _factor(POWERS.get(unit, {}), sizes) * multiple_of(unit, sizes)


def multiple_of(unit: str, sizes: Mapping[str, float]) -> float:
    """Return the factor on a number of the catalogue; 1 for a joint, whose sizes are no multiples."""
    return _factor(_IN_MACHINES.get(unit, {}), sizes)


def _factor(powers: Mapping[str, int], sizes: Mapping[str, float]) -> float:
    return math.prod((sizes.get(name, 1.0) ** power for name, power in powers.items()), start=1.0)


def _joint(signals: Signals, constants: Mapping[str, Any]) -> dict[str, float]:
    """Return effort, travel, speed and current of an axis, and the resistance of its motor."""
    sizes: dict[str, float] = {}
    if "position" in signals:
        sizes["travel"] = _PEAK_TO_PEAK * float(signals["position"].std(correction=0))
    if "velocity" in signals:
        sizes["speed"] = _rms(signals["velocity"])
    if "effort" in signals:
        sizes["effort"] = _rms(signals["effort"])
    if "voltage" in signals and "torque_constant" in constants:
        constant = constants["torque_constant"] * constants["gear_ratio"]
        current = (signals["voltage"] - constant * signals["velocity"]) / constants["resistance"]
        sizes = {"effort": _rms(constant * current), **sizes, "current": _rms(current)}
        sizes["resistance"] = float(constants["resistance"])
    if "position_command" in signals and "proportional" in constants:
        error = signals["position_command"] - signals["position"]
        sizes = {"effort": _rms(servo_effort(error, signals["velocity"], constants)), **sizes}
    sizes["effort"] = max(sizes.get("effort", 0.0), _within(signals, constants))
    return {name: size for name, size in sizes.items() if size > _LEAST}


def _within(signals: Signals, constants: Mapping[str, Any]) -> float:
    """Return the effort that inertia and known load take: near a resonance far more than what drives the axis.

    The acceleration is that of a sine with the recorded spreads, v²/x. By the inequality of Cauchy and Schwarz it is at
    most the true one, and noise in the velocity is not differentiated.
    """
    numbers = {"inertia", "gravity_torque", "stiffness"}
    if not {"position", "velocity"} <= signals.keys() or not numbers <= constants.keys():
        return 0.0
    position, spread = signals["position"], float(signals["position"].std(correction=0))
    acceleration = float(signals["velocity"].var(correction=0)) / max(spread, _LEAST)
    load = constants["gravity_torque"] * position.sin() + constants["stiffness"] * position
    return max(constants["inertia"] * acceleration, _rms(load))


def _rms(series: Tensor) -> float:
    return float(series.square().mean().sqrt())


def _quadrotor(constants: Mapping[str, Any]) -> dict[str, float]:
    """Return the mean arm, m, the weight at its end, N·m, and the speed of a rotor in hover, rad/s."""
    reach = float(constants["rotor_positions"][:, :2].norm(dim=-1).mean())
    weight = float(constants["mass"] * constants["gravity"])
    turning = math.sqrt(weight / (4.0 * float(constants["thrust_coefficient"])))
    return {"reach": reach, "torque": weight * reach, "turning": turning}


def _swerve(constants: Mapping[str, Any]) -> dict[str, float]:
    """Return the radius of a wheel, m, and the torque with which it lifts its share of the weight, N·m."""
    reach, weight = float(constants["wheel_radius"]), float(constants["mass"] * constants["gravity"])
    return {"reach": reach, "torque": 0.25 * weight * reach}


_OF_PLATFORM: Mapping[str, Callable[[Mapping[str, Any]], dict[str, float]]] = {
    "quadrotor": _quadrotor,
    "swerve": _swerve,
}
_USUAL: Mapping[str, Mapping[str, float]] = {
    "quadrotor": {"reach": 0.125, "torque": 1.067, "turning": 1168.0},
    "swerve": {"reach": 0.0508, "torque": 6.73},
}
"""Sizes of the machines for which the catalogue's numbers hold."""
