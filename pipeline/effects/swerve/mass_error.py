"""A mass of a swerve drive that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class MassError(ParameterError):
    """The mass differs from the platform file (ratio of true to nominal)."""

    name = "mass_error"
    kind = "swerve"
    acts_on = "drive"
    spread = 0.2  # a scale tells it, with or without battery and bumpers
    names_its_subject = True
    formula = "mass = ratio · nominal mass"
    source = "the platform's nominal equations"
    sentence = "The mass is {ratio} times the value in the platform file; correct it."
    excitation = "accelerate hard in a straight line"
    symptom = "Straight-line acceleration is off by a constant factor."
    look_alikes = ("motor_constant_error",)

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the mass scaled."""
        return {**constants, "mass": values["ratio"] * constants["mass"]}
