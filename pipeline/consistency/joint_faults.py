"""What may have been done to the recording of a joint."""

import numpy as np

from simgap.consistency.plausible import supply_of
from simgap.consistency.samples import Samples
from simgap.consistency.transformation import Transformation, scaled, taken
from simgap.consistency.units import (
    ANGLE,
    ANGULAR_RATE,
    CLOCK,
    COUNTS,
    CURRENT,
    LENGTH,
    PUSH,
    SPEED,
    TORQUE,
    VOLTAGE,
    duty,
    in_two_units,
    in_units,
)
from simgap.platforms.joint import Joint

_SIGN = 0.06  # odds: the commonest fault beside units
_SIGN_OF_BOTH = 0.02  # the drive is turned more often than both sensors
_GEAR = 0.06


def joint_faults(samples: Samples, joint: Joint | None, sliding: bool) -> list[Transformation]:
    """Return the transformations of a joint's columns.

    Args:
        samples: of the recording.
        joint: the platform, where it is known.
        sliding: whether the position is in metres.
    """
    motion = ("position", "velocity")
    lengths, rates = (LENGTH, SPEED) if sliding else (ANGLE, ANGULAR_RATE)
    found = [
        *in_units("velocity", ("velocity",), rates),
        *in_units("position", ("position",), lengths),
        *in_units("velocity", ("velocity",), COUNTS),
        *in_units("position", ("position",), COUNTS),
        *in_two_units("position and velocity", ((("position",), lengths), (("velocity",), rates))),
        *in_units("t", ("t",), CLOCK),
        taken("sign", "velocity", {"velocity": "-velocity"}, _SIGN),
        taken("sign", "position", {"position": "-position"}, _SIGN),
        taken("sign", "position and velocity", {name: f"-{name}" for name in motion}, _SIGN_OF_BOTH),
        *_drives(samples, sliding),
    ]
    gear = joint.motor.gear_ratio if joint is not None and joint.motor is not None else 1.0
    return found + (_geared(samples, gear) if abs(np.log(gear)) > np.log(1.5) else [])


def _drives(samples: Samples, sliding: bool) -> list[Transformation]:
    found = []
    efforts = PUSH if sliding else TORQUE
    told = LENGTH if sliding else ANGLE
    drives = (("effort", efforts), ("voltage", VOLTAGE), ("current", CURRENT), ("position_command", told))
    for column, units in drives:
        if column in samples:
            found += in_units(column, (column,), units)
            found.append(taken("sign", column, {column: f"-{column}"}, _SIGN))
    if "voltage" in samples:
        largest = float(np.nanquantile(np.abs(samples["voltage"]), 0.999))
        found += duty("voltage", ("voltage",), largest, supply_of(samples))
    return found


def _geared(samples: Samples, gear: float) -> list[Transformation]:
    """Return the transformations between both sides of the gear."""
    words = "of the motor, before the gear"
    key = f"scale: {1.0 / gear:.4g}"
    found = [
        scaled("gear_ratio", column, columns, gear, odds, key, words)
        for column, columns, odds in (
            ("velocity", ("velocity",), _GEAR),
            ("position", ("position",), _GEAR),
            ("position and velocity", ("position", "velocity"), _GEAR),
        )
    ]
    if "effort" in samples:
        found.append(
            scaled("gear_ratio", "effort", ("effort",), 1.0 / gear, _GEAR, f"scale: {gear:.4g}", words)
        )
    return found
