"""Model of a straight drive from the system identification of a swerve drive."""

import math
from pathlib import Path
from typing import Any

import torch
import yaml
from torch import Tensor

from simgap.errors import InputError
from simgap.platforms import Swerve
from simgap.policies.profile.drive import Drive

_GAINS = ("kS", "kV", "kA")
_REMEDY = "run simgap sysid on drives straight ahead"


def identified_drive(
    path: Path,
    platform: Swerve,
    voltage_limit: float,
    acceleration_limit: float = math.inf,
    device: torch.device | str = "cpu",
) -> Drive:
    """Return the drive that sysid found, straight ahead.

    Its motors are known per rad/s; the rolling radius that was identified beside them, or else the platform's, makes
    that metres along the ground.

    Args:
        path: of the `parameters.yaml` that sysid wrote.
        platform: for the gear's ratio.
        voltage_limit: greatest voltage, V.
        acceleration_limit: of the tyres' grip, m/s².
        device: of the tensors.

    Raises:
        InputError: when the file cannot be read, or has not all of the motors' constants.
    """
    try:
        found = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise InputError(f"cannot be read: {error}", str(path), _REMEDY) from error
    radius = _value(found.get("wheels", {}).get("rolling_radius"))
    motor_turns = platform.drive.gear_ratio / (radius or platform.wheel_radius)  # rad/m
    static, speed, acceleration = (_constants(found, name, path, device) for name in _GAINS)
    return Drive(static, speed * motor_turns, acceleration * motor_turns, voltage_limit, acceleration_limit)


def _constants(found: dict[str, Any], name: str, path: Path, device: torch.device | str) -> Tensor:
    values = [_value(found.get(f"drive_{number}", {}).get(name)) for number in range(1, 5)]
    if None in values:
        raise InputError(f"{name} of a drive motor is not known", str(path), _REMEDY)
    return torch.tensor(values, dtype=torch.float32, device=device)


def _value(parameter: dict[str, Any] | None) -> float | None:
    return parameter["value"] if parameter else None
