"""Delay between command and effect of a joint."""

from simgap.effects.delay import CommandDelay


class JointCommandDelay(CommandDelay):
    """The voltage or effort acts later than it was recorded."""

    kind = "joint"
    delayed = ("voltage", "effort")
