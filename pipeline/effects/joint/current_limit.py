"""Limit on the motor current of a joint."""

from simgap.effects.current_limit import CurrentLimit


class JointCurrentLimit(CurrentLimit):
    """The controller limits the motor current, whatever voltage is commanded."""

    kind = "joint"
    acts_on = "actuator"
    needs = ("voltage",)
    limited = "effort"
    sentence = "The controller limits the motor current to {limit} A; apply the limit in the simulator."
    look_alikes = ("battery_sag", "motor_constant_error")
