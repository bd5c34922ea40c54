"""Dry friction of a swerve drive that fades as the speed grows (Stribeck effect), for wheels and steering."""

import torch
from torch import Tensor

from simgap.effects.dry_friction import DryFriction, Sliding, dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.scan import scan
from simgap.effects.swerve.common import ModuleFriction, WheelFriction, module_load, wheel_load, wheel_speed
from simgap.physics.shapes import PerModule


class _SwerveStribeckFriction(DryFriction):
    """Friction is larger near standstill and fades as the speed grows."""

    name = "stribeck_friction"
    kind = "swerve"
    parameters = (
        Parameter("extra_level", "N·m", 0.5, 0.0, 1e3),
        Parameter("velocity", "rad/s", 0.5, 1e-3, 1e3, neutral=1.0),
    )
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, eq. 2.7"
    look_alikes = ("coulomb_friction",)

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: without an excess the fading velocity has no gradient."""
        return scan(extra_level=(0.03, 0.3, 3.0), velocity=(0.1, 1.0, 10.0))


class DriveStribeckFriction(_SwerveStribeckFriction, WheelFriction):
    """A driven wheel needs more torque near standstill than while it turns."""

    formula = (
        "wheel torque = −extra_level · exp(−(ω / velocity)²) · sign(ω), ω of the wheel; at standstill it holds, up to "
        "extra_level"
    )
    sentence = (
        "Breakaway of each driven wheel takes {extra_level} N·m more than rolling, and the excess fades over "
        "{velocity} rad/s; add Stribeck friction to the drive."
    )
    excitation = (
        "ramp the voltage very slowly through standstill, and hold crawling speeds forward and backward"
    )
    symptom = "The wheels stick, break away with a jerk, and then need less torque."

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the friction about each axle, (..., 4) N·m."""
        sliding = sliding_of(signals, constants, "drive_")
        return _friction(wheel_speed(signals, constants), wheel_load(signals), values, sliding)


class SteerStribeckFriction(_SwerveStribeckFriction, ModuleFriction):
    """A steering module needs more torque near standstill than while it turns."""

    formula = (
        "module torque = −extra_level · exp(−(ω / velocity)²) · sign(ω), ω of the module; at standstill it holds, up "
        "to extra_level"
    )
    sentence = (
        "Breakaway of each steering module takes {extra_level} N·m more than turning, and the excess fades "
        "over {velocity} rad/s; add Stribeck friction to the steering."
    )
    excitation = "turn the modules very slowly in both directions, and hold crawling rates"
    symptom = "The modules stick, break away with a jerk, and then need less torque."

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the friction on each module, (..., 4) N·m."""
        sliding = sliding_of(signals, constants, "steer_")
        return _friction(signals["steer_velocity"], module_load(signals, constants), values, sliding)


def _friction(speed: Tensor, applied: Tensor, values: Values, slides: Sliding) -> Tensor:
    level = values["extra_level"] * torch.exp(-(slides.moving(speed) / values["velocity"]).square())
    return dry_friction(level, speed, applied, slides)
