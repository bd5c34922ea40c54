"""Delay between command and effect of a joint."""

from pipeline.effects.delay import CommandDelay


class JointCommandDelay(CommandDelay):
    """The voltage or effort acts later than it was recorded."""

    kind = "joint"
    delayed = ("voltage", "effort")
