"""A thrust coefficient that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class ThrustCoefficientError(ParameterError):
    """The thrust coefficient differs from the platform file (ratio of true to nominal)."""

    name = "thrust_coefficient_error"
    kind = "quadrotor"
    acts_on = "force"
    spread = 0.2  # propeller tables and thrust stands differ by a tenth or two
    formula = "thrust_coefficient = ratio · nominal thrust_coefficient"
    source = "the platform's nominal equations"
    sentence = "The thrust coefficient is {ratio} times the value in the platform file; correct it."
    excitation = "hover, climb, and roll quickly to both sides"
    symptom = "Thrust, roll torque and pitch torque are off by the same factor."

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the thrust coefficient scaled."""
        return {**constants, "thrust_coefficient": values["ratio"] * constants["thrust_coefficient"]}
