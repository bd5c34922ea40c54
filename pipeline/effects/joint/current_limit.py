"""A motor controller that caps the current of a joint."""

from typing import Any

from torch import Tensor

from pipeline.effects.effect import ActuatorEffect, Parameter, Signals, Values


class CurrentLimit(ActuatorEffect):
    """Motor current held under a limit, whatever voltage is commanded."""

    name = "current_limit"
    kind = "joint"
    acts_on = "actuator"
    parameters = (Parameter("limit", "A", 40.0, 0.01, 1e4, neutral=1e4),)
    needs = ("voltage",)
    formula = "|voltage − K·velocity| / resistance ≤ limit"
    source = "smart motor controllers' stator current limit; Krishnan 2001, Electric motor drives, §2"
    sentence = "The controller caps the motor's current at {limit} A; limit it in the simulator."
    excitation = "full-voltage steps from standstill"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a limit that is never reached leaves no slope to follow."""
        return [{"limit": 0.25 * 1.6**step} for step in range(15)]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Tensor], Any]:
        """Return the effort that no more than the limiting current can give."""
        most = values["limit"] * constants["torque_constant"] * constants["gear_ratio"]
        return {"effort": signals["effort"].clamp(-most, most)}, None
