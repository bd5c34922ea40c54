"""Delay between the command of a joint and its effect."""

from simgap.effects.delay import CommandDelay


class JointCommandDelay(CommandDelay):
    """The voltage, effort or position command acts a fixed time after it is recorded."""

    kind = "joint"
    look_alikes = ("motor_inductance",)
    delayed = ("voltage", "effort", "position_command")
