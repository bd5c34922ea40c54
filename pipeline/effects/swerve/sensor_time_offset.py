"""Motion of a swerve drive recorded on another clock than its motors' voltages.

A late log looks as late commands do to the drive and to the steering at once: one offset in the place of two delays.
"""

from simgap.effects.time_offset import TimeOffset


class SwerveTimeOffset(TimeOffset):
    """The motion of chassis, wheels and modules reaches the log late with respect to the voltages."""

    kind = "swerve"
    acts_on = "chassis"
    on_command_clock = ("drive_voltage", "steer_voltage")
    sentence = (
        "The robot's motion was recorded {offset} s late with respect to the motors' voltages, or drive and steering "
        "both obey that much later, which looks the same; shift the clocks before anything is fitted."
    )
    excitation = (
        "fast chirps or steps of drive and steering voltage, so that voltage and acceleration can be aligned"
    )
