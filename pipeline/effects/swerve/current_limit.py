"""Motor controllers that cap the current of a swerve drive's motors."""

from simgap.effects.current_limit import CurrentLimit


class DriveCurrentLimit(CurrentLimit):
    """The drive motors' current is capped."""

    kind = "swerve"
    acts_on = "drive"
    group = "drive_"
    limited = "drive_torque"
    sentence = "The controllers cap each drive motor's current at {limit} A; limit it in the simulator."


class SteerCurrentLimit(CurrentLimit):
    """The steering motors' current is capped."""

    kind = "swerve"
    acts_on = "steer"
    group = "steer_"
    limited = "steer_torque"
    sentence = "The controllers cap each steering motor's current at {limit} A; limit it in the simulator."
