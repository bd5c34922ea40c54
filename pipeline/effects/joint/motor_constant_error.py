"""A motor constant of a joint that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class MotorConstantError(ParameterError):
    """True over nominal motor constant."""

    name = "motor_constant_error"
    kind = "joint"
    acts_on = "actuator"
    needs = ("voltage",)
    formula = "torque_constant = ratio · nominal torque_constant"
    source = "the platform's nominal equations"
    sentence = "The motor constant is {ratio} times what the platform file says; correct it."
    excitation = "hold several constant speeds, and accelerate hard"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the motor constant scaled."""
        return {**constants, "torque_constant": values["ratio"] * constants["torque_constant"]}
