"""Delay between the voltages of a swerve drive and their effect."""

from simgap.effects.delay import CommandDelay


class DriveCommandDelay(CommandDelay):
    """Drive voltages act a fixed time after they are recorded."""

    kind = "swerve"
    acts_on = "drive"
    delayed = ("drive_voltage",)
    sentence = "Drive voltages take effect {delay} s after they are recorded; delay them in the simulator."
    look_alikes = ("motor_inductance",)


class SteerCommandDelay(CommandDelay):
    """Steering voltages act a fixed time after they are recorded."""

    kind = "swerve"
    acts_on = "steer"
    delayed = ("steer_voltage",)
    sentence = "Steering voltages take effect {delay} s after they are recorded; delay them in the simulator."
    look_alikes = ("motor_inductance",)
