"""Platform with the parameters that system identification found."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from simgap.effects import effect_by_key
from simgap.errors import InputError
from simgap.platforms import Joint, Platform, Quadrotor
from simgap.simulation.simulator import FittedEffect

_COEFFICIENTS = ("thrust_coefficient", "torque_coefficient")


def with_identified(platform: Platform, path: Path) -> tuple[Platform, tuple[FittedEffect, ...]]:
    """Return the platform with the identified parameters, and the identified friction.

    Args:
        platform: as a person knew it.
        path: the `parameters.yaml` that sysid wrote.

    Raises:
        InputError: when the file cannot be read or the kind of platform has no such parameters.
    """
    try:
        found = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise InputError(f"cannot be read: {error}", str(path), "run simgap sysid") from error
    if isinstance(platform, Quadrotor):
        return _quadrotor(platform, found), ()
    if isinstance(platform, Joint) and platform.motor is not None:
        return _joint(platform, found)
    raise InputError("no identified parameters fit this platform", "simulator.identified", "set it to false")


def _quadrotor(platform: Quadrotor, found: Mapping[str, Any]) -> Quadrotor:
    values = {name: entry["value"] for name, entry in found.items() if entry["value"] is not None}
    moments = [
        values.get(f"inertia_{axis}", nominal)
        for axis, nominal in zip(("xx", "yy", "zz"), platform.inertia, strict=True)
    ]
    changed = {name: values[name] for name in _COEFFICIENTS if name in values}
    return replace(platform, inertia=(moments[0], moments[1], moments[2]), **changed)


def _joint(platform: Joint, found: Mapping[str, Any]) -> tuple[Joint, tuple[FittedEffect, ...]]:
    """Turn the mean feedforward of the motors, V = kS·sign(v) + kV·v + kA·a, into resistance, constant and friction."""
    assert platform.motor is not None
    static, speed, acceleration = (
        float(np.mean([motor[gain]["value"] for motor in found.values()])) for gain in ("kS", "kV", "kA")
    )
    resistance = acceleration * speed / platform.inertia
    motor = replace(platform.motor, resistance=resistance, torque_constant=speed / platform.motor.gear_ratio)
    friction = FittedEffect(
        effect_by_key("joint", "coulomb_friction"), {"level": static * speed / resistance}, known=True
    )
    return replace(platform, motor=motor), (friction,)
