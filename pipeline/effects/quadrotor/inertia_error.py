"""A inertia that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class InertiaError(ParameterError):
    """True over nominal inertia."""

    name = "inertia_error"
    kind = "quadrotor"
    acts_on = "torque"
    formula = "inertia = ratio · nominal inertia"
    source = "the platform's nominal equations"
    sentence = "The moments of inertia are {ratio} times what the platform file says; correct them."
    excitation = "roll, pitch and yaw quickly to and fro"

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the inertia scaled."""
        return {**constants, "inertia": values["ratio"] * constants["inertia"]}
