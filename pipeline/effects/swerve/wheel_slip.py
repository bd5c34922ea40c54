"""Traction limit of the wheels of a swerve drive."""

from typing import Any

import torch
from torch import Tensor

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.swerve.common import wheel_angle
from simgap.physics.shapes import Signal
from simgap.platforms.swerve_slip import SLIDING, SPINNING

# Share of a wheel's nominal load: acceleration shifts load, so a light wheel slides first and a heavy one last.
_LIGHTEST, _LIGHT, _HEAVIEST = 0.7, 0.8, 1.2
_NO_FORCE = 1e-9  # N, so that the root has a finite gradient at rest


class WheelSlip(ActuatorEffect):
    """Friction with the floor limits the combined pull and side force of each wheel."""

    order = 3
    name = "wheel_slip"
    kind = "swerve"
    acts_on = "drive"
    names_its_subject = True
    parameters = (Parameter("friction_coefficient", "1", 0.9, 0.02, 100.0, neutral=100.0),)
    formula = (
        "√(pull² + side force²) ≤ friction_coefficient · mass · gravity / 4 for each wheel, both cut alike; beyond it "
        "a wheel slides, seen where the chassis' own motion is measured (in a simulation wheels roll)"
    )
    source = "Pacejka 2012, Tire and vehicle dynamics, §1.2.2: the friction circle"
    sentence = (
        "The wheels slip when they pull harder than {friction_coefficient} times their load; limit the "
        "traction in the simulator."
    )
    excitation = "step to full voltage from standstill and brake hard, straight ahead and in curves"
    symptom = "At full voltage the wheels turn faster than the chassis moves."

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a grip that is never used up gives no gradient."""
        return [{"friction_coefficient": 0.05 * 1.5**step} for step in range(12)]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the torques within the traction limit, and the degree of sliding of each wheel."""
        load = 0.25 * constants["mass"] * constants["gravity"]
        pull = signals["drive_torque"] / constants["wheel_radius"]
        force = torch.sqrt(pull.square() + _side_force(signals, constants).square() + _NO_FORCE**2)
        used = force / (values["friction_coefficient"] * load)
        sliding = ((used - _LIGHTEST) / (_LIGHT - _LIGHTEST)).clamp(0.0, 1.0)
        spinning = ((used - 1.0) / (_HEAVIEST - 1.0)).clamp(0.0, 1.0)
        return {
            "drive_torque": signals["drive_torque"] / used.clamp_min(1.0),
            SLIDING: sliding,
            SPINNING: spinning * torch.sign(pull),
        }, None


def _side_force(signals: Signals, constants: Values) -> Tensor:
    """Return the centripetal force across each wheel, (..., 4) N, at equal wheel loads."""
    x, y, yaw = signals["chassis_velocity"].unbind(-1)
    angle = wheel_angle(signals["steer_angle"], constants)
    inward = torch.cos(angle) * (yaw * x)[..., None] + torch.sin(angle) * (yaw * y)[..., None]
    return 0.25 * constants["mass"] * inward
