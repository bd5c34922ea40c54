"""Motor controllers that cap the current of a swerve drive's motors."""

from typing import Any

from torch import Tensor

from pipeline.effects.effect import ActuatorEffect, Parameter, Signals, Values


class _SwerveCurrentLimit(ActuatorEffect):
    """Motor current held under a limit, whatever voltage is commanded."""

    name = "current_limit"
    kind = "swerve"
    parameters = (Parameter("limit", "A", 40.0, 0.1, 1e4, neutral=1e4),)
    formula = "|voltage − K_e·motor speed| / resistance ≤ limit"
    source = "smart motor controllers' stator current limit; Krishnan 2001, Electric motor drives, §2"
    excitation = "full-voltage steps from standstill"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a limit that is never reached leaves no slope to follow."""
        return [{"limit": 0.25 * 1.6**step} for step in range(15)]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Tensor], Any]:
        """Return the torques that no more than the limiting current can give."""
        group = self.acts_on
        most = values["limit"] * constants[f"{group}_gear_ratio"] * constants[f"{group}_torque_constant"]
        return {f"{group}_torque": signals[f"{group}_torque"].clamp(-most, most)}, None


class DriveCurrentLimit(_SwerveCurrentLimit):
    """The drive motors' current is capped."""

    acts_on = "drive"
    sentence = "The controllers cap each drive motor's current at {limit} A; limit it in the simulator."


class SteerCurrentLimit(_SwerveCurrentLimit):
    """The steering motors' current is capped."""

    acts_on = "steer"
    sentence = "The controllers cap each steering motor's current at {limit} A; limit it in the simulator."
