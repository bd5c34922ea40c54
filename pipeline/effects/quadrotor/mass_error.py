"""A mass that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class MassError(ParameterError):
    """True over nominal mass."""

    name = "mass_error"
    kind = "quadrotor"
    acts_on = "force"
    formula = "mass = ratio · nominal mass"
    source = "the platform's nominal equations"
    sentence = "The machine weighs {ratio} times what the platform file says; correct its mass."
    excitation = (
        "hover and climb; a mass is told from a thrust coefficient only where torques show the thrust as well"
    )

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the mass scaled."""
        return {**constants, "mass": values["ratio"] * constants["mass"]}
