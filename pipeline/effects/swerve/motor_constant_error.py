"""Motor constants of a swerve drive that differ from the platform file."""

from simgap.effects.effect import ParameterError, Values


class _SwerveMotorConstantError(ParameterError):
    """The motor constant differs from the platform file, for torque and back-EMF alike."""

    name = "motor_constant_error"
    drifts = True
    kind = "swerve"
    formula = "torque_constant = ratio · nominal torque_constant, back_emf_constant likewise"
    source = "the platform's nominal equations"
    symptom = "At constant voltage both the initial torque and the final speed are off."
    look_alikes = ("viscous_friction",)

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with both motor constants scaled."""
        names = (f"{self.acts_on}_torque_constant", f"{self.acts_on}_back_emf_constant")
        return {**constants, **{name: values["ratio"] * constants[name] for name in names}}


class DriveMotorConstantError(_SwerveMotorConstantError):
    """The drive motors' constant differs from the platform file (ratio of true to nominal)."""

    acts_on = "drive"
    spread = 0.2  # data sheets promise a tenth, and a hot magnet loses another
    sentence = "The drive motors' constant is {ratio} times the value in the platform file; correct it."
    excitation = "hold several constant speeds, and accelerate hard"


class SteerMotorConstantError(_SwerveMotorConstantError):
    """The steering motors' constant differs from the platform file (ratio of true to nominal)."""

    acts_on = "steer"
    sentence = "The steering motors' constant is {ratio} times the value in the platform file; correct it."
    excitation = "turn the modules at several constant rates, and reverse them hard"
