"""A joint's motor whose current takes time to rise."""

from simgap.effects.motor_inductance import MotorInductance


class JointMotorInductance(MotorInductance):
    """Current that follows the voltage with the winding's time constant, inductance over resistance."""

    kind = "joint"
    acts_on = "actuator"
    needs = ("voltage",)
    delayed = "effort"
    sentence = "The motor's inductance of {inductance} H delays its current; add it to the simulator."
