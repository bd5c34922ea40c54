"""An inertia of a swerve drive that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class InertiaError(ParameterError):
    """The inertia differs from the platform file (ratio of true to nominal)."""

    name = "inertia_error"
    kind = "swerve"
    acts_on = "drive"
    names_its_subject = True
    formula = "inertia = ratio · nominal inertia"
    source = "the platform's nominal equations"
    sentence = "The inertia is {ratio} times the value in the platform file; correct it."
    excitation = "accelerate and brake hard while turning on the spot"
    symptom = "The yaw acceleration is off by a constant factor."
    look_alikes = ("mass_error",)

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the inertia scaled."""
        return {**constants, "inertia": values["ratio"] * constants["inertia"]}
