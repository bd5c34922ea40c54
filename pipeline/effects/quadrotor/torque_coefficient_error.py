"""A torque coefficient that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class TorqueCoefficientError(ParameterError):
    """The torque coefficient differs from the platform file (ratio of true to nominal)."""

    name = "torque_coefficient_error"
    kind = "quadrotor"
    acts_on = "torque"
    formula = "torque_coefficient = ratio · nominal torque_coefficient"
    source = "the platform's nominal equations"
    sentence = "The torque coefficient is {ratio} times the value in the platform file; correct it."
    excitation = "yaw quickly to both sides"
    symptom = "Yaw acceleration is off by a constant factor, while roll and pitch fit."

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the torque coefficient scaled."""
        return {**constants, "torque_coefficient": values["ratio"] * constants["torque_coefficient"]}
