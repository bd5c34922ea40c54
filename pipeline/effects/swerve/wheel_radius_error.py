"""Wheels of a swerve drive that are smaller or greater than the platform file says."""

from simgap.effects.effect import ParameterError, Values


class WheelRadiusError(ParameterError):
    """True over nominal wheel radius."""

    name = "wheel_radius_error"
    kind = "swerve"
    acts_on = "drive"
    formula = "wheel_radius = ratio · nominal wheel_radius"
    source = "the platform's nominal equations"
    sentence = (
        "The wheels' radius is {ratio} times what the platform file says, as worn treads make it; correct it."
    )
    excitation = "accelerate hard in a straight line, with the chassis' own motion measured"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the wheel radius scaled."""
        return {**constants, "wheel_radius": values["ratio"] * constants["wheel_radius"]}
