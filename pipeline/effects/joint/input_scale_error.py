"""Scale of the recorded voltage or effort of a joint.

One wrong factor between what is recorded and what acts: the unit of a driver's register, the sensitivity of a current
sensor, a supply that is not the nominal one. A wrong motor constant also changes the back-EMF; a wrong inertia leaves
the weight, the spring and friction as they are. This factor does neither.
"""

from typing import Any

from simgap.effects.effect import CommandEffect, ParameterError, Signals, Values
from simgap.effects.joint.common import commanded
from simgap.physics.shapes import Signal


class InputScaleError(ParameterError, CommandEffect):
    """The voltage or effort that acts is the recorded one times a constant factor (ratio of true to recorded)."""

    name = "input_scale_error"
    kind = "joint"
    acts_on = "command"
    needs = ("effort",)
    formula = "command_effective = ratio · command"
    source = "the platform's nominal equations"
    sentence = "The input that acts is {ratio} times the recorded one; correct its scale."
    excitation = "hold the axis against a known weight or spring, and also accelerate and brake hard"
    symptom = "Acceleration, weight, spring and friction all seem off by the same factor."
    look_alikes = ("inertia_error", "motor_constant_error")

    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants as they are: the factor is the recording's, not the machine's."""
        return dict(constants)

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the input that acts."""
        name = commanded(signals)
        return {name: values["ratio"] * signals[name]}, None
