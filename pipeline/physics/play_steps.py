"""Compiled time loop of a motor's motion through gear backlash."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True)
def slips_in_play(
    place: Array, push: Array, turn: Array, half: float, damped: float, time_step: float
) -> Array:
    """Return the speed of motors relative to their axes, step by step as in `simgap.effects.backlash`.

    Args:
        place: of the motors in the gap at first, (motors,) rad.
        push: what the effort adds to a motor's speed in a step, (motors, steps) rad/s.
        turn: what the axis's speed changes by in a step, (motors, steps) rad/s.
        half: of the gap, rad.
        damped: share of its slip that a motor keeps in a step.
        time_step: s.

    Returns:
        slips after each step, (motors, steps) rad/s.
    """
    slips = np.empty_like(push)
    for motor in range(len(place)):
        now, slip = place[motor], 0.0
        for step in range(push.shape[1]):
            free = turn[motor, step] if abs(now) < half else 0.0
            alone = (slip + push[motor, step] - free) * damped
            moved = min(max(now + time_step * alone, -half), half)
            slip = (moved - now) / time_step
            slips[motor, step] = slip
            now = moved
    return slips
