"""A motor constant of a joint that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class MotorConstantError(ParameterError):
    """The motor constant differs from the platform file (ratio of true to nominal)."""

    name = "motor_constant_error"
    drifts = True
    kind = "joint"
    acts_on = "actuator"
    spread = 0.2  # data sheets promise a tenth, and a hot magnet loses another
    needs = ("voltage",)
    formula = "torque_constant = ratio · nominal torque_constant"
    source = "the platform's nominal equations"
    sentence = "The motor constant is {ratio} times the value in the platform file; correct it."
    excitation = "hold several constant speeds, and accelerate hard"
    symptom = "At constant voltage both the initial torque and the final speed are off."
    look_alikes = ("viscous_friction",)

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the motor constant scaled."""
        return {**constants, "torque_constant": values["ratio"] * constants["torque_constant"]}
