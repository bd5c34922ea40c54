"""Motor constants of a swerve drive that differ from the platform file."""

from simgap.effects.effect import ParameterError, Values


class _SwerveMotorConstantError(ParameterError):
    """True over nominal motor constant, of torque and back-EMF alike."""

    name = "motor_constant_error"
    kind = "swerve"
    formula = "torque_constant = ratio · nominal torque_constant, back_emf_constant likewise"
    source = "the platform's nominal equations"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with both motor constants scaled."""
        names = (f"{self.acts_on}_torque_constant", f"{self.acts_on}_back_emf_constant")
        return {**constants, **{name: values["ratio"] * constants[name] for name in names}}


class DriveMotorConstantError(_SwerveMotorConstantError):
    """True over nominal motor constant of the drive motors."""

    acts_on = "drive"
    sentence = "The drive motors' constant is {ratio} times what the platform file says; correct it."
    excitation = "hold several constant speeds, and accelerate hard"


class SteerMotorConstantError(_SwerveMotorConstantError):
    """True over nominal motor constant of the steering motors."""

    acts_on = "steer"
    sentence = "The steering motors' constant is {ratio} times what the platform file says; correct it."
    excitation = "turn the modules at several constant rates, and reverse them hard"
