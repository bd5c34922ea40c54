"""Compiled time loop of swinging cables, because tensor operations are too slow for such small steps."""

from math import sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True)
def swung(
    direction: Array, rate: Array, apparent: Array, length: Array, time_step: float
) -> tuple[Array, Array]:
    """Return direction and rate of cables along steps, as `simgap.physics.cable.swing` takes each of them.

    Args:
        direction: of the cables at first, unit, (cables, 3).
        rate: of the direction, across it, (cables, 3) 1/s.
        apparent: gravity less the acceleration of the upper end, (cables, steps, 3) m/s².
        length: of each cable, (cables,) m.
        time_step: s.

    Returns:
        directions and rates, (cables, steps, 3) each, from the start on.
    """
    cables, steps, _ = apparent.shape
    directions, rates = np.empty((cables, steps, 3)), np.empty((cables, steps, 3))
    for cable in range(cables):
        kick = 0.5 * time_step / length[cable]
        towards, turning = direction[cable].copy(), rate[cable].copy()
        free = np.empty(3)
        for step in range(steps):
            directions[cable, step], rates[cable, step] = towards, turning
            if step + 1 < steps:
                move(towards, turning, free, apparent[cable], step, kick, time_step)
    return directions, rates


@njit(cache=True)
def move(
    towards: Array, turning: Array, free: Array, apparent: Array, step: int, kick: float, time_step: float
) -> None:
    """Take one step of a cable, in place, as `simgap.physics.cable.swing` does.

    Args:
        towards: its direction, unit, (3,).
        turning: rate of the direction, across it, (3,) 1/s.
        free: room for three numbers.
        apparent: gravity less the acceleration of the upper end, along all steps, (steps, 3) m/s².
        step: that is taken, before the last one.
        kick: half of the time step over the length, s/m.
        time_step: s.
    """
    onward = size = 0.0
    for axis in range(3):
        free[axis] = towards[axis] + time_step * (turning[axis] + kick * apparent[step, axis])
        onward += free[axis] * towards[axis]
        size += free[axis] * free[axis]
    back = sqrt(max(onward * onward - size + 1.0, 0.0)) - onward
    outward = 0.0
    for axis in range(3):
        turned = free[axis] + back * towards[axis]
        turning[axis] = (turned - towards[axis]) / time_step + kick * apparent[step + 1, axis]
        towards[axis] = turned
        outward += turning[axis] * turned
    for axis in range(3):
        turning[axis] -= outward * towards[axis]
