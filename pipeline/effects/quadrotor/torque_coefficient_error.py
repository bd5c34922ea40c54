"""A torque coefficient that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class TorqueCoefficientError(ParameterError):
    """True over nominal torque coefficient."""

    name = "torque_coefficient_error"
    kind = "quadrotor"
    acts_on = "torque"
    formula = "torque_coefficient = ratio · nominal torque_coefficient"
    source = "the platform's nominal equations"
    sentence = (
        "The rotors' reaction torque is {ratio} times what the platform file says; correct its coefficient."
    )
    excitation = "yaw quickly to and fro"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the torque coefficient scaled."""
        return {**constants, "torque_coefficient": values["ratio"] * constants["torque_coefficient"]}
