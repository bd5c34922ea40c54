"""A thrust coefficient that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class ThrustCoefficientError(ParameterError):
    """True over nominal thrust coefficient."""

    name = "thrust_coefficient_error"
    kind = "quadrotor"
    acts_on = "force"
    formula = "thrust_coefficient = ratio · nominal thrust_coefficient"
    source = "the platform's nominal equations"
    sentence = (
        "The rotors push {ratio} times as hard as the platform file says; correct the thrust coefficient."
    )
    excitation = "hover, climb, and roll quickly to and fro"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the thrust coefficient scaled."""
        return {**constants, "thrust_coefficient": values["ratio"] * constants["thrust_coefficient"]}
