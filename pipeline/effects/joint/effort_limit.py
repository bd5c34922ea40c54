"""Limit on the effort of a servo.

A servo's drive limits its current, and with it its effort, however far the axis is from where it is told to be. Nothing
is known of the motor behind a position command, so that the limit is an effort and no current.
"""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Signal


class EffortLimit(ActuatorEffect):
    """The servo pushes no harder than a limit, however far it is from its command."""

    order = 1
    name = "effort_limit"
    kind = "joint"
    acts_on = "actuator"
    parameters = (Parameter("limit", "N·m", 1.0, 0.01, 1e4, neutral=1e4),)
    needs = ("position_command",)
    formula = "|effort| ≤ limit"
    source = "Åström & Hägglund 2006, Advanced PID control, §3.5: saturation of the actuator"
    sentence = "The servo pushes with {limit} {limit_unit} at most; limit its effort in the simulator."
    excitation = "command large steps, and small ones beside them"
    symptom = "A large step begins no harder than a middling one."
    look_alikes = ("controller_gain_error",)

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a limit that is never reached gives no gradient."""
        return [{"limit": 0.25 * 1.6**step} for step in range(9)]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the limited effort."""
        return {"effort": signals["effort"].clamp(-values["limit"], values["limit"])}, None
