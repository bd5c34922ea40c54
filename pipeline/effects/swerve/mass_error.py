"""A mass of a swerve drive that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class MassError(ParameterError):
    """True over nominal mass."""

    name = "mass_error"
    kind = "swerve"
    acts_on = "drive"
    formula = "mass = ratio · nominal mass"
    source = "the platform's nominal equations"
    sentence = "The mass is {ratio} times what the platform file says; correct it."
    excitation = "accelerate hard in a straight line"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the mass scaled."""
        return {**constants, "mass": values["ratio"] * constants["mass"]}
