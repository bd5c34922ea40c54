"""Time offset between the state of a joint and its motor.

On one axis a late log looks like a late command. Only the sign of the offset or a second sensor separates the two.
"""

from simgap.effects.time_offset import TimeOffset


class JointTimeOffset(TimeOffset):
    """Position and velocity are recorded late relative to the commands, or early if negative."""

    kind = "joint"
    late = "position and velocity"
    needs = ("effort",)
    on_command_clock = ("voltage", "effort", "position_command")
    excitation = "run a fast chirp or command steps, so that command and acceleration can be aligned"
