"""Friction of the wheels and modules of a swerve drive, shared by its effects."""

from torch import Tensor

from pipeline.effects.effect import Signals, Values
from pipeline.platforms.swerve_mechanism import per_module, sum_on_chassis


def wheel_speed(signals: Signals, constants: Values) -> Tensor:
    """Speed of each wheel about its axle, (..., 4) rad/s."""
    return signals["drive_velocity"] / constants["drive_gear_ratio"]


def on_wheels(torque: Tensor, signals: Signals, constants: Values) -> dict[str, Tensor]:
    """Sum a torque about each wheel's axle (..., 4) N·m on the chassis."""
    return sum_on_chassis(torque, signals["steer_angle"], constants)


def on_modules(torque: Tensor) -> dict[str, Tensor]:
    """Name a torque about each module's axis (..., 4) N·m as the steering channels."""
    return per_module(torque)
