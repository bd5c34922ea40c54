"""A inertia of a swerve drive that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class InertiaError(ParameterError):
    """True over nominal inertia."""

    name = "inertia_error"
    kind = "swerve"
    acts_on = "drive"
    formula = "inertia = ratio · nominal inertia"
    source = "the platform's nominal equations"
    sentence = "The inertia is {ratio} times what the platform file says; correct it."
    excitation = "spin up and down hard on the spot"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the inertia scaled."""
        return {**constants, "inertia": values["ratio"] * constants["inertia"]}
