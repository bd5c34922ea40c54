"""Moments of inertia that differ from the platform file."""

from simgap.effects.effect import Parameter, ParameterError, Values


class InertiaError(ParameterError):
    """The moments of inertia differ from the platform file (ratio of true to nominal)."""

    name = "inertia_error"
    kind = "quadrotor"
    acts_on = "torque"
    # Few measure it: it is estimated from arms and masses, and a decade either way happens.
    parameters = (Parameter("ratio", "1", 1.2, 0.1, 10.0, neutral=1.0),)
    formula = "inertia = ratio · nominal inertia"
    source = "the platform's nominal equations"
    sentence = "The moments of inertia are {ratio} times the values in the platform file; correct them."
    excitation = "roll, pitch and yaw quickly in both directions"
    symptom = "Angular accelerations are off by the same factor about every axis."
    look_alikes = ("thrust_coefficient_error", "torque_coefficient_error")

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the inertia scaled."""
        return {**constants, "inertia": values["ratio"] * constants["inertia"]}
