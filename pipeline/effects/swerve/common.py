"""Friction of the wheels and modules of a swerve drive, shared by its effects."""

from simgap.effects.dry_friction import DryFriction
from simgap.effects.effect import Signals, Values
from simgap.physics.shapes import Channels, PerModule
from simgap.platforms.swerve_mechanism import (
    on_chassis,
    per_module,
    steering_torque,
    sum_on_chassis,
    wheel_angle,
)

__all__ = [
    "ModuleFriction",
    "WheelFriction",
    "module_load",
    "on_chassis",
    "on_modules",
    "on_wheels",
    "steering_torque",
    "wheel_angle",
    "wheel_load",
    "wheel_speed",
]


class WheelFriction(DryFriction):
    """Dry friction about the axle of each wheel."""

    kind = "swerve"
    acts_on = "drive"
    holds = "wheel_load"
    on_each = True

    def on_channels(self, friction: PerModule, signals: Signals, constants: Values) -> Channels:
        """Return the friction summed on the chassis."""
        return on_wheels(friction, signals, constants)


class ModuleFriction(DryFriction):
    """Dry friction about the vertical axis of each module."""

    kind = "swerve"
    acts_on = "steer"
    holds = "module_load"
    on_each = True

    def on_channels(self, friction: PerModule, signals: Signals, constants: Values) -> Channels:
        """Return the friction on each module, N·m."""
        return on_modules(friction)


def wheel_load(signals: Signals) -> PerModule:
    """Return the load on friction at each standing wheel, (..., 4) N·m: the remaining load, else the motor torque."""
    return signals.get(WheelFriction.holds, signals["drive_torque"])


def module_load(signals: Signals, constants: Values) -> PerModule:
    """Return the load on friction at each standing module, (..., 4) N·m: the remaining load, else the motor torque."""
    if ModuleFriction.holds in signals:
        return signals[ModuleFriction.holds]
    return steering_torque(signals, constants)


def wheel_speed(signals: Signals, constants: Values) -> PerModule:
    """Return the speed of each wheel about its axle, (..., 4) rad/s, without the gear coupling to the module."""
    driven = signals["drive_velocity"] - constants["coupling_ratio"] * signals["steer_velocity"]
    return driven / constants["drive_gear_ratio"]


def on_wheels(torque: PerModule, signals: Signals, constants: Values) -> Channels:
    """Sum a torque about each wheel's axle (..., 4) N·m on the chassis."""
    return sum_on_chassis(torque, signals["steer_angle"], constants)


def on_modules(torque: PerModule) -> Channels:
    """Name a torque about each module's axis (..., 4) N·m as the steering channels."""
    return per_module(torque)
