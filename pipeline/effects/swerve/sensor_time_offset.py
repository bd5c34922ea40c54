"""Time offset between the motion of a swerve drive and its voltages.

A late log looks like late drive and steering commands at once: one offset replaces two delays.
"""

from simgap.effects.time_offset import TimeOffset


class SwerveTimeOffset(TimeOffset):
    """Chassis, wheel and module motion is recorded late relative to the voltages, or early if negative."""

    kind = "swerve"
    acts_on = "chassis"
    late = "motion"
    on_command_clock = ("drive_voltage", "steer_voltage")
    sentence = (
        "The motion was recorded {offset} s late relative to the voltages, which looks like an equal delay of"
        " drive and steering; shift the clocks before you fit anything."
    )
    excitation = (
        "run fast chirps or steps of drive and steering voltage, so that voltage and acceleration can be "
        "aligned"
    )
