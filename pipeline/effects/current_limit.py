"""A cap on a motor's current, shared by every platform with a motor controller."""

from typing import Any, ClassVar

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Signal


class CurrentLimit(ActuatorEffect):
    """Motor current held under a limit, whatever voltage is commanded."""

    group: ClassVar[str] = ""
    """What the names of the signal and of the constants begin with: a swerve's `drive_` or `steer_`."""
    limited: ClassVar[str]
    """The signal that follows the current: effort or torque."""

    order = 1
    name = "current_limit"
    parameters = (Parameter("limit", "A", 40.0, 0.01, 1e4, neutral=1e4),)
    formula = "|voltage − K·velocity| / resistance ≤ limit"
    source = "smart motor controllers' stator current limit; Krishnan 2001, Electric motor drives, §2"
    excitation = "full-voltage steps from standstill"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a limit that is never reached leaves no slope to follow."""
        return [{"limit": 0.25 * 1.6**step} for step in range(15)]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the effort that no more than the limiting current can give."""
        per_ampere = constants[f"{self.group}torque_constant"] * constants[f"{self.group}gear_ratio"]
        most = values["limit"] * per_ampere
        return {self.limited: signals[self.limited].clamp(-most, most)}, None
