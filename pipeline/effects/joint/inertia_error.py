"""A inertia of a joint that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class InertiaError(ParameterError):
    """True over nominal inertia."""

    name = "inertia_error"
    kind = "joint"
    acts_on = "torque"
    needs = ()
    formula = "inertia = ratio · nominal inertia"
    source = "the platform's nominal equations"
    sentence = "The inertia is {ratio} times what the platform file says; correct it."
    excitation = "speed up and slow down hard"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the inertia scaled."""
        return {**constants, "inertia": values["ratio"] * constants["inertia"]}
