"""Gains of a servo's position loop that differ from the platform file.

Only a gain that was given can be wrong. One that was not is identified, and has no name.
"""

from typing import Any

from simgap.effects.effect import Parameter, ParameterError, Values


class ControllerGainError(ParameterError):
    """The gains of the position loop differ from the platform file (ratios of true to nominal)."""

    name = "controller_gain_error"
    kind = "joint"
    acts_on = "actuator"
    parameters = (
        Parameter("proportional", "1", 1.3, 0.1, 10.0, neutral=1.0),
        Parameter("derivative", "1", 1.3, 0.1, 10.0, neutral=1.0),
    )
    needs = ("position_command",)
    formula = (
        "effort = proportional · nominal proportional · (position_command − position) − derivative · nominal "
        "derivative · velocity"
    )
    source = "the platform's nominal equations; Åström & Hägglund 2006, Advanced PID control, §3.3"
    sentence = (
        "The position loop has {proportional} times the proportional and {derivative} times the derivative gain in the "
        "platform file; correct them."
    )
    excitation = (
        "command steps of several sizes with a known inertia on the axis, and log the effort or the current"
    )
    symptom = "After a step the axis swings faster or slower, or is damped more or less, than its gains say."
    look_alikes = ("viscous_friction", "linear_stiffness", "inertia_error", "input_scale_error")

    def fits(self, constants: Values) -> bool:
        """Whether any gain was given."""
        return bool(constants.get("given_gains"))

    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants with the gains scaled that were given."""
        scaled = {name: values[name] * constants[name] for name in constants.get("given_gains", ())}
        return {**constants, **scaled}
