"""Limit on a motor's current, for every platform with a motor controller."""

from typing import Any, ClassVar

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Signal


class CurrentLimit(ActuatorEffect):
    """The controller limits the motor current, whatever voltage is commanded."""

    group: ClassVar[str] = ""
    """Prefix of the names of signals and constants: `drive_` or `steer_` for a swerve drive."""
    limited: ClassVar[str]
    """The signal that follows the current: effort or torque."""

    order = 1
    name = "current_limit"
    parameters = (Parameter("limit", "A", 40.0, 0.01, 1e4, neutral=1e4),)
    formula = "|voltage − K·velocity| / resistance ≤ limit"
    source = "smart motor controllers' stator current limit; Krishnan 2001, Electric motor drives, §2"
    excitation = "step to full voltage from standstill"
    symptom = "A large voltage step gives less acceleration than its voltage allows, at a constant level."

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a limit that is never reached gives no gradient."""
        return [{"limit": 0.25 * 1.6**step} for step in range(15)]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the effort at the limited current."""
        per_ampere = constants[f"{self.group}torque_constant"] * constants[f"{self.group}gear_ratio"]
        most = values["limit"] * per_ampere
        return {self.limited: signals[self.limited].clamp(-most, most)}, None
