"""The ground's resistance against turning a wheel about the vertical."""

import torch

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.scan import scan
from simgap.effects.swerve.common import ModuleFriction, module_load, wheel_speed
from simgap.physics.shapes import PerModule


class ScrubTorque(ModuleFriction):
    """Each tyre's patch rubs as its module turns, at full strength at rest and the less the faster the wheel rolls."""

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
        "The ground holds each standing wheel back with {level} N·m when its module turns, less when it rolls (patch "
        "of {patch_radius} m); add scrub torque to the steering."
    )
    excitation = "turn the modules at rest and while rolling at several speeds"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: the radius has no slope where nothing rubs."""
        return scan(level=(0.1, 1.0, 10.0), patch_radius=(0.005, 0.02, 0.1))

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the torque on each module, (..., 4) N·m."""
        turning, sliding = signals["steer_velocity"], sliding_of(signals, constants, "steer_")
        rolling = wheel_speed(signals, constants) * constants["wheel_radius"]
        rubbing = values["patch_radius"] ** 2 * (turning.square() + sliding.velocity**2)
        level = values["level"] * torch.sqrt(rubbing / (rubbing + rolling.square()))
        return dry_friction(level, turning, module_load(signals, constants), sliding)
