"""State of a joint recorded on another clock than its motor.

A late log of one axis looks as a late command does: only the sign, or a second sensor, tells them apart.
"""

from simgap.effects.time_offset import TimeOffset


class JointTimeOffset(TimeOffset):
    """Position and velocity reach the log late with respect to voltage or effort (early where negative)."""

    kind = "joint"
    needs = ("effort",)
    on_command_clock = ("voltage", "effort")
    excitation = "a fast chirp or command steps, so that command and acceleration can be aligned"
