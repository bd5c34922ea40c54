"""Delay between command and effect of a quadrotor."""

from simgap.effects.delay import CommandDelay


class QuadrotorCommandDelay(CommandDelay):
    """The motors act later than their command was recorded."""

    kind = "quadrotor"
    delayed = ("motor_command",)
    needs = ("motor_command",)
