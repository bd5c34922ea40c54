"""Limit on the motor currents of a swerve drive."""

from simgap.effects.current_limit import CurrentLimit


class DriveCurrentLimit(CurrentLimit):
    """The controllers limit the current of the drive motors."""

    kind = "swerve"
    acts_on = "drive"
    group = "drive_"
    limited = "drive_torque"
    sentence = (
        "The controllers limit each drive motor's current to {limit} A; apply the limit in the simulator."
    )
    look_alikes = ("battery_sag", "wheel_slip")


class SteerCurrentLimit(CurrentLimit):
    """The controllers limit the current of the steering motors."""

    kind = "swerve"
    acts_on = "steer"
    group = "steer_"
    limited = "steer_torque"
    sentence = (
        "The controllers limit each steering motor's current to {limit} A; apply the limit in the simulator."
    )
    look_alikes = ("battery_sag",)
