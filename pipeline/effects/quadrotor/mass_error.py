"""A mass that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class MassError(ParameterError):
    """The mass differs from the platform file (ratio of true to nominal)."""

    name = "mass_error"
    kind = "quadrotor"
    acts_on = "force"
    spread = 0.1  # a scale tells it; a battery or a camera more changes it by a tenth
    formula = "mass = ratio · nominal mass"
    source = "the platform's nominal equations"
    sentence = "The mass is {ratio} times the value in the platform file; correct it."
    excitation = (
        "hover and climb, and roll hard, since only torques separate a mass from a thrust coefficient"
    )
    symptom = "Specific forces are off by a constant factor, while torques fit."
    look_alikes = ("thrust_coefficient_error",)

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the mass scaled."""
        return {**constants, "mass": values["ratio"] * constants["mass"]}
