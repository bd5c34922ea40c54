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

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Tensor], Any]:
        """Return the voltages that drive no more than the limit through each winding."""
        group = self.acts_on
        ratio = constants["steer_gear_ratio"] if group == "steer" else 1.0
        back_emf = constants[f"{group}_back_emf_constant"] * ratio * signals[f"{group}_velocity"]
        drop = values["limit"] * constants[f"{group}_resistance"]
        excess = (signals[f"{group}_voltage"] - back_emf).clamp(-drop, drop)
        return {f"{group}_voltage": back_emf + excess}, None


class DriveCurrentLimit(_SwerveCurrentLimit):
    """The drive motors' current is capped."""

    acts_on = "drive"
    sentence = "The controllers cap each drive motor's current at {limit} A; limit it in the simulator."


class SteerCurrentLimit(_SwerveCurrentLimit):
    """The steering motors' current is capped."""

    acts_on = "steer"
    sentence = "The controllers cap each steering motor's current at {limit} A; limit it in the simulator."
