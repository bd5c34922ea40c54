"""Friction torque of a tyre patch that turns about the vertical."""

import torch

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.scan import scan
from simgap.effects.swerve.common import ModuleFriction, module_load, wheel_speed
from simgap.physics.shapes import PerModule


class ScrubTorque(ModuleFriction):
    """The tyre patch resists rotation about the vertical, most at rest and less while the wheel rolls."""

    name = "scrub_torque"
    parameters = (
        Parameter("level", "N·m", 1.0, 0.0, 1e3),
        Parameter("patch_radius", "m", 0.02, 1e-3, 0.5, neutral=0.01),
    )
    formula = (
        "module torque = −level · patch_radius·ω / √((patch_radius·ω)² + v²), ω of the module, v of rolling; at rest "
        "it holds, up to level"
    )
    source = "Pacejka 2012, Tire and vehicle dynamics, §9.2: turn slip and spin torque of a rubbing patch"
    sentence = (
        "Tyre scrub holds each standing wheel with {level} N·m (patch radius {patch_radius} m), and less "
        "while it rolls; add scrub torque to the steering."
    )
    excitation = "turn the modules at rest and while rolling at several speeds"
    symptom = "Steering needs more torque at rest than while the robot drives."
    look_alikes = ("coulomb_friction", "stribeck_friction")

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: without friction the radius has no gradient."""
        return scan(level=(0.1, 1.0, 10.0), patch_radius=(0.005, 0.02, 0.1))

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the torque on each module, (..., 4) N·m."""
        turning, sliding = signals["steer_velocity"], sliding_of(signals, constants, "steer_")
        rolling = wheel_speed(signals, constants) * constants["wheel_radius"]
        rubbing = values["patch_radius"] ** 2 * (turning.square() + sliding.velocity**2)
        level = values["level"] * torch.sqrt(rubbing / (rubbing + rolling.square()))
        return dry_friction(level, turning, module_load(signals, constants), sliding)
