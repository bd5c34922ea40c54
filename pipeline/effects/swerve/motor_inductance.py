"""Electrical time constants of the motors of a swerve drive."""

from simgap.effects.effect import Parameter
from simgap.effects.motor_inductance import MotorInductance

_OF_STRONG_MOTORS = (Parameter("inductance", "H", 2e-3, 0.0, 10.0),)


class DriveMotorInductance(MotorInductance):
    """The drive motors' current follows the voltage with the winding's time constant."""

    kind = "swerve"
    acts_on = "drive"
    parameters = _OF_STRONG_MOTORS
    group = "drive_"
    delayed = "drive_torque"
    sentence = "The drive motors' inductance of {inductance} H delays the current; add it to the simulator."


class SteerMotorInductance(MotorInductance):
    """The steering motors' current follows the voltage with the winding's time constant."""

    kind = "swerve"
    acts_on = "steer"
    parameters = _OF_STRONG_MOTORS
    group = "steer_"
    delayed = "steer_torque"
    sentence = (
        "The steering motors' inductance of {inductance} H delays the current; add it to the simulator."
    )
