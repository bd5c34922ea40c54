"""A wheel radius of a swerve drive that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class WheelRadiusError(ParameterError):
    """The wheel radius differs from the platform file (ratio of true to nominal)."""

    name = "wheel_radius_error"
    kind = "swerve"
    acts_on = "drive"
    spread = 0.1  # a ruler tells it; treads wear by a tenth
    names_its_subject = True
    formula = "wheel_radius = ratio · nominal wheel_radius"
    source = "the platform's nominal equations"
    sentence = (
        "The wheel radius is {ratio} times the value in the platform file, which worn treads make smaller; "
        "correct it."
    )
    excitation = "accelerate hard in a straight line, and record the chassis' own motion"
    symptom = "Wheel speed and chassis speed disagree by a constant factor."
    look_alikes = ("mass_error", "motor_constant_error")

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the wheel radius scaled."""
        return {**constants, "wheel_radius": values["ratio"] * constants["wheel_radius"]}
