"""Delay between voltage and effect in a swerve drive."""

from simgap.effects.delay import CommandDelay


class DriveCommandDelay(CommandDelay):
    """The drive voltages act later than they were recorded."""

    kind = "swerve"
    acts_on = "drive"
    delayed = ("drive_voltage",)
    sentence = "Drive voltages take effect {delay} s after they are recorded; delay them in the simulator."


class SteerCommandDelay(CommandDelay):
    """The steering voltages act later than they were recorded."""

    kind = "swerve"
    acts_on = "steer"
    delayed = ("steer_voltage",)
    sentence = "Steering voltages take effect {delay} s after they are recorded; delay them in the simulator."
