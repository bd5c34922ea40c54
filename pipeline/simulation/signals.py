"""Physical signals of mechanisms and effects, from the columns of a recording."""

import numpy as np
import pandas as pd
import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.physics import rotations
from simgap.physics.shapes import Signal
from simgap.platforms import Joint, Platform, Swerve
from simgap.platforms.swerve_kinematics import heading_of
from simgap.platforms.swerve_mechanism import MEASURED, ROLLED, SwerveMechanism, twist_from_wheels

_AXES = ("x", "y", "z")
_QUATERNION = ("w", "x", "y", "z")
_FOUR = ("1", "2", "3", "4")
COMMANDS = frozenset(
    {"motor_command", "effort", "voltage", "position_command", "drive_voltage", "steer_voltage"}
)
"""Signals that a controller holds from one sample to the next."""


def rates_of(platform: Platform) -> dict[str, str]:
    """Return which signals are integrals of another one, for signals in which forces are nearly linear.

    Angles that rotate forces are excluded: the mean force over a step does not act at the mean angle.
    """
    return {"position": "velocity"} if isinstance(platform, Joint) else {}


def recorded_signals(frame: pd.DataFrame, platform: Platform, held: bool = True) -> dict[str, Signal]:
    """Return the signals of one uniformly sampled stretch, each (samples, ...) float64.

    A signal with a missing value is left out.

    Args:
        frame: columns of the contract.
        platform: whose signals are read.
        held: whether a command is held from its sample to the next, as a controller does, so that what acts around a
            sample is the mean of it and the one before; else a command was measured at its sample.
    """
    if isinstance(platform, Swerve):
        return _swerve(frame, platform, held)
    return _joint(frame, platform, held) if isinstance(platform, Joint) else _quadrotor(frame, held)


def _quadrotor(frame: pd.DataFrame, held: bool) -> dict[str, Tensor]:
    signals = {
        "position": _columns(frame, "position", _AXES),
        "attitude": _columns(frame, "attitude", _QUATERNION),
        "velocity": _columns(frame, "velocity", _AXES),
        "body_rate": _columns(frame, "body_rate", _AXES),
        "specific_force": _columns(frame, "specific_force", _AXES),
        "rotor_speed": _columns(frame, "motor_speed", _FOUR),
        "motor_command": _mean_while_held(_columns(frame, "motor_command", _FOUR), held),
        "battery_voltage": _column(frame, "battery_voltage"),
    }
    present = {name: series for name, series in signals.items() if series is not None}
    if "velocity" in present:
        present["velocity"] = rotations.rotate_inverse(present["attitude"], present["velocity"])
    return present


def _joint(frame: pd.DataFrame, platform: Joint, held: bool) -> dict[str, Tensor]:
    signals = {
        "position": _column(frame, "position"),
        "velocity": _column(frame, "velocity"),
        "effort": _mean_while_held(_column(frame, "effort"), held),
        "voltage": _mean_while_held(_column(frame, "voltage"), held),
        "position_command": _mean_while_held(_column(frame, "position_command"), held),
        "battery_voltage": _column(frame, "battery_voltage"),
        "temperature": _column(frame, "temperature"),
    }
    present = {name: series for name, series in signals.items() if series is not None}
    if "voltage" in present and platform.motor is None:
        if not {"effort", "position_command"} & present.keys():
            remedy = "give resistance, torque_constant and gear_ratio, or record the effort"
            raise InputError("is missing, and the recording has a voltage", "platform.motor", remedy)
        del present["voltage"]
    if {"voltage", "effort"} & present.keys():
        present.pop("position_command", None)  # what the loop made of it is known
    return present


def _swerve(frame: pd.DataFrame, platform: Swerve, held: bool) -> dict[str, Tensor]:
    signals = {
        "drive_voltage": _mean_while_held(_columns(frame, "drive_voltage", _FOUR), held),
        "steer_voltage": _mean_while_held(_columns(frame, "steer_voltage", _FOUR), held),
        "drive_velocity": _columns(frame, "drive_velocity", _FOUR),
        "steer_velocity": _columns(frame, "steer_velocity", _FOUR),
        "steer_angle": _columns(frame, "steer_angle", _FOUR),
        "battery_voltage": _column(frame, "battery_voltage"),
    }
    present = {name: series for name, series in signals.items() if series is not None}
    measured = [_column(frame, name) for name in ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")]
    if all(series is not None for series in measured):
        present[MEASURED] = torch.stack([series for series in measured if series is not None], dim=-1)
    else:
        present[ROLLED] = twist_from_wheels(present, SwerveMechanism(platform).constants())
    present["chassis_velocity"] = present[MEASURED if MEASURED in present else ROLLED]
    time = torch.from_numpy(frame["t"].to_numpy(dtype=np.float64, copy=True))
    present["heading"] = heading_of(present["chassis_velocity"], time)
    return present


def _column(frame: pd.DataFrame, name: str) -> Tensor | None:
    if name not in frame or frame[name].isna().any():
        return None
    return torch.from_numpy(frame[name].to_numpy(dtype=np.float64, copy=True))


def _columns(frame: pd.DataFrame, stem: str, suffixes: tuple[str, ...]) -> Tensor | None:
    series = [_column(frame, f"{stem}_{suffix}") for suffix in suffixes]
    complete = [entry for entry in series if entry is not None]
    return torch.stack(complete, dim=-1) if len(complete) == len(series) else None


def _mean_while_held(series: Tensor | None, held: bool) -> Tensor | None:
    if series is None or not held:
        return series
    return 0.5 * (series + torch.cat([series[:1], series[:-1]]))
