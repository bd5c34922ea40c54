"""The position loop of a servo."""

from collections.abc import Mapping
from typing import Any

from simgap.physics.shapes import Signal


def servo_effort(error: Signal, velocity: Signal, constants: Mapping[str, Any]) -> Signal:
    """Return clip(proportional · error − derivative · velocity, ±effort_limit), (...,) N·m or N.

    Åström & Hägglund 2006, Advanced PID control, §3.3: the derivative acts on the measurement alone.

    Args:
        error: what is commanded less where the axis is, (...,) rad or m.
        velocity: (...,) rad/s or m/s.
        constants: `proportional` N·m/rad, `derivative` N·m·s/rad and `effort_limit` N·m.
    """
    effort = constants["proportional"] * error - constants["derivative"] * velocity
    return effort.clamp(-constants["effort_limit"], constants["effort_limit"])
