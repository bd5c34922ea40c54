"""Electrical time constant of a joint's motor."""

from simgap.effects.motor_inductance import MotorInductance


class JointMotorInductance(MotorInductance):
    """The motor current follows the voltage with a time constant of inductance over resistance."""

    kind = "joint"
    acts_on = "actuator"
    needs = ("voltage",)
    delayed = "effort"
    sentence = "The motor inductance of {inductance} H delays the current; add it to the simulator."
