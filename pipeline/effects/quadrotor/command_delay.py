"""Delay between the motor commands of a quadrotor and their effect."""

from simgap.effects.delay import CommandDelay


class QuadrotorCommandDelay(CommandDelay):
    """The motors act a fixed time after their command is recorded."""

    kind = "quadrotor"
    delayed = ("motor_command",)
    needs = ("motor_command",)
    look_alikes = ("motor_lag",)
