"""A motor controller that caps the current of a joint."""

from simgap.effects.current_limit import CurrentLimit


class JointCurrentLimit(CurrentLimit):
    """Motor current held under a limit, whatever voltage is commanded."""

    kind = "joint"
    acts_on = "actuator"
    needs = ("voltage",)
    limited = "effort"
    sentence = "The controller caps the motor's current at {limit} A; limit it in the simulator."
