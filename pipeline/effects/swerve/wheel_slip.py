"""Wheels of a swerve drive that lose their grip."""

from typing import Any

import torch
from torch import Tensor

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.swerve.common import wheel_angle
from simgap.physics.shapes import Signal
from simgap.platforms.swerve_mechanism import LEAST_SLIP, SLIDING

# Of a wheel's share of the weight: accelerations shift load, a light wheel slides first and a heavy one last.
_LIGHTEST, _LIGHT, _HEAVIEST = 0.7, 0.8, 1.2
_NO_FORCE = 1e-9  # N, lest the root has no slope at rest


class WheelSlip(ActuatorEffect):
    """Each wheel pulls no harder than its grip allows, of which a curve takes a part; beyond that it slides."""

    order = 3
    name = "wheel_slip"
    kind = "swerve"
    acts_on = "drive"
    parameters = (Parameter("friction_coefficient", "1", 0.9, 0.02, 100.0, neutral=100.0),)
    formula = (
        "√(pull² + side force²) ≤ friction_coefficient · mass · gravity / 4 for each wheel, both cut alike; beyond it "
        "a wheel slides, seen where the chassis' own motion is measured (in a simulation wheels roll)"
    )
    source = "Pacejka 2012, Tire and vehicle dynamics, §1.2.2: the friction circle"
    sentence = (
        "The wheels slip where they pull harder than {friction_coefficient} times their load; limit the traction in "
        "the simulator."
    )
    excitation = "full-voltage steps from standstill and hard braking, straight ahead and in curves"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a grip that is never used up leaves no slope to follow."""
        return [{"friction_coefficient": 0.05 * 1.5**step} for step in range(12)]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the torques that the ground can answer, and whether a wheel may slide, and has to."""
        load = 0.25 * constants["mass"] * constants["gravity"]
        pull = signals["drive_torque"] / constants["wheel_radius"]
        force = torch.sqrt(pull.square() + _side_force(signals, constants).square() + _NO_FORCE**2)
        used = force / (values["friction_coefficient"] * load)
        sliding = ((used - _LIGHTEST) / (_LIGHT - _LIGHTEST)).clamp(0.0, 1.0)
        spinning = ((used - 1.0) / (_HEAVIEST - 1.0)).clamp(0.0, 1.0)
        return {
            "drive_torque": signals["drive_torque"] / used.clamp_min(1.0),
            SLIDING: sliding,
            LEAST_SLIP: constants["creep"] * spinning * torch.sign(pull),
        }, None


def _side_force(signals: Signals, constants: Values) -> Tensor:
    """Return what keeps the robot in its curve across each wheel, (..., 4) N, the load spread evenly."""
    x, y, yaw = signals["chassis_velocity"].unbind(-1)
    angle = wheel_angle(signals["steer_angle"], constants)
    inward = torch.cos(angle) * (yaw * x)[..., None] + torch.sin(angle) * (yaw * y)[..., None]
    return 0.25 * constants["mass"] * inward
