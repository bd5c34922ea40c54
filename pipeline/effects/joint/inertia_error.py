"""An inertia of a joint that differs from the platform file."""

from simgap.effects.effect import Parameter, ParameterError, Values


class InertiaError(ParameterError):
    """The inertia differs from the platform file (ratio of true to nominal)."""

    name = "inertia_error"
    kind = "joint"
    prior_odds = 0.7  # the inertia of a rotor, behind a gear most of an axis' inertia, is rarely published
    spread = 0.7
    acts_on = "torque"
    # A rotor behind a gear of 100 counts 10,000 times, and few data sheets give it: a decade either way is possible.
    parameters = (Parameter("ratio", "1", 1.2, 0.1, 10.0, neutral=1.0),)
    needs = ()
    formula = "inertia = ratio · nominal inertia"
    source = "the platform's nominal equations"
    sentence = "The inertia is {ratio} times the value in the platform file; correct it."
    excitation = "accelerate and brake hard"
    symptom = "The acceleration is off by the same factor at every effort."
    look_alikes = ("linear_stiffness", "motor_constant_error")

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the inertia scaled."""
        return {**constants, "inertia": values["ratio"] * constants["inertia"]}
