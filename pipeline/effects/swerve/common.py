"""Friction of the wheels and modules of a swerve drive, shared by its effects."""

from torch import Tensor

from pipeline.effects.effect import Signals, Values
from pipeline.platforms.swerve_mechanism import (
    on_chassis,
    per_module,
    steering_torque,
    sum_on_chassis,
    wheel_angle,
)

__all__ = ["on_chassis", "on_modules", "on_wheels", "steering_torque", "wheel_angle", "wheel_speed"]


def wheel_speed(signals: Signals, constants: Values) -> Tensor:
    """Speed of each wheel about its axle, (..., 4) rad/s; what turning the module adds to the motor's is taken out."""
    driven = signals["drive_velocity"] - constants["coupling_ratio"] * signals["steer_velocity"]
    return driven / constants["drive_gear_ratio"]


def on_wheels(torque: Tensor, signals: Signals, constants: Values) -> dict[str, Tensor]:
    """Sum a torque about each wheel's axle (..., 4) N·m on the chassis."""
    return sum_on_chassis(torque, signals["steer_angle"], constants)


def on_modules(torque: Tensor) -> dict[str, Tensor]:
    """Name a torque about each module's axis (..., 4) N·m as the steering channels."""
    return per_module(torque)
