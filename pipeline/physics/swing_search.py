"""Compiled search for the starts of swinging cables, because tensor operations are too slow for such small steps."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from simgap.physics.cable_steps import Array, move

_GROWING = (0.25, 0.5, 0.75, 1.0)  # parts of a record: a shorter part has fewer local minima
_CORRECTIONS = 3  # Levenberg-Marquardt steps on each part of a record
_DAMPING = 0.01  # initial damping of a step
_EASED, _TIGHTENED = 0.25, 8.0  # its factor after a better and after a worse step
_SLIGHT_ANGLE = 1e-3  # rad, step of the finite differences
_USUAL = 1.0  # rad, prior deviation of the cable from the apparent gravity
_LEAST = 1e-12  # of a sum of squared errors
_NUMBERS = 4  # of a start: two angles from rest, and two rates relative to the natural frequency


class Swinging(NamedTuple):
    """What all cables have in common.

    Attributes:
        length: m.
        pace: how fast they swing, rad/s.
        time_step: of the steps, s.
        mass_ratio: of load and machine.
        memory: correlation time of the accelerations, s.
    """

    length: float
    pace: float
    time_step: float
    mass_ratio: float
    memory: float


class _Record(NamedTuple):
    """What one machine felt, along steps of equal length.

    Attributes:
        apparent: gravity, world frame, (steps, 3) m/s².
        axes: x and y of the body, world frame, (steps, 2, 3); zero where a step does not count.
        counted: steps that count.
        resting: initial direction of the cable at rest, (3,).
        sides: two directions across it, (2, 3).
    """

    apparent: Array
    axes: Array
    counted: float
    resting: Array
    sides: Array


@njit(cache=True)
def first_swings(
    apparent: Array, axes: Array, counted: Array, resting: Array, sides: Array, swinging: Swinging
) -> tuple[Array, Array]:
    """Return direction and rate of cables at first, by Levenberg-Marquardt steps on growing parts of their records.

    Args:
        apparent: gravity, world frame, (cables, steps, 3) m/s².
        axes: x and y of the body, world frame, (cables, steps, 2, 3); zero where a step does not count.
        counted: steps that count, from the beginning to each, (cables, steps).
        resting: initial direction of the apparent gravity, (cables, 3).
        sides: two directions across it, (cables, 2, 3).
        swinging: what all cables have in common.

    Returns:
        unit directions, and their rates, 1/s, (cables, 3) each.
    """
    towards, turning = np.empty(resting.shape), np.empty(resting.shape)
    for cable in range(len(apparent)):
        off = np.zeros(_NUMBERS)
        for part in _GROWING:
            steps = max(round(part * apparent.shape[1]), 2)
            record = _Record(
                apparent[cable, :steps],
                axes[cable, :steps],
                counted[cable, steps - 1],
                resting[cable],
                sides[cable],
            )
            off = _corrected(off, record, swinging)
        towards[cable], turning[cable] = _start(off, resting[cable], sides[cable], swinging.pace)
    return towards, turning


@njit(cache=True)
def _corrected(off: Array, record: _Record, swinging: Swinging) -> Array:
    """Return a better start than one that is guessed, (4,) each."""
    damping = _DAMPING
    felt = _felt(record)
    shown, slopes = _swung(off, record, swinging)
    error = felt - shown
    for _ in range(_CORRECTIONS):
        tried = off + _correction(off, error, slopes, damping, record, swinging)
        shown, others = _swung(tried, record, swinging)
        other = felt - shown
        if (other * other).sum() < (error * error).sum():
            off, error, slopes = tried, other, others
            damping *= _EASED
        else:
            damping *= _TIGHTENED
    return off


@njit(cache=True)
def _correction(
    off: Array, error: Array, slopes: Array, damping: float, record: _Record, swinging: Swinging
) -> Array:
    """Return the next step of a start, (4,)."""
    independent = record.counted * swinging.time_step / swinging.memory
    weight = independent / max((error * error).sum(), _LEAST)
    square = weight * slopes @ slopes.T
    uphill = weight * slopes @ error - off / _USUAL**2
    for place in range(_NUMBERS):
        square[place, place] += damping * square[place, place] + _USUAL**-2
    return np.linalg.solve(square, uphill)


@njit(cache=True)
def _swung(off: Array, record: _Record, swinging: Swinging) -> tuple[Array, Array]:
    """Return the accelerations that a start leads to, (2·steps,) m/s², and their slopes by it, (4, 2·steps)."""
    shown = _pulled(off, record, swinging)
    slopes = np.empty((_NUMBERS, len(shown)))
    for place in range(_NUMBERS):
        aside = off.copy()
        aside[place] += _SLIGHT_ANGLE
        slopes[place] = (_pulled(aside, record, swinging) - shown) / _SLIGHT_ANGLE
    return shown, slopes


@njit(cache=True)
def _felt(record: _Record) -> Array:
    """Return the accelerations across the thrust, (2·steps,) m/s²."""
    felt = np.zeros((len(record.apparent), 2))
    for step in range(len(record.apparent)):
        for side in range(2):
            for axis in range(3):
                felt[step, side] -= record.axes[step, side, axis] * record.apparent[step, axis]
    return felt.flatten()


@njit(cache=True)
def _pulled(off: Array, record: _Record, swinging: Swinging) -> Array:
    """Return the accelerations across the thrust that a cable makes from a start on, (2·steps,) m/s²."""
    kick = 0.5 * swinging.time_step / swinging.length
    towards, turning = _start(off, record.resting, record.sides, swinging.pace)
    free, shown = np.empty(3), np.empty((len(record.apparent), 2))
    for step in range(len(record.apparent)):
        tension = 0.0
        for axis in range(3):
            tension += swinging.length * turning[axis] ** 2 + towards[axis] * record.apparent[step, axis]
        pull = swinging.mass_ratio * max(tension, 0.0)
        for side in range(2):
            along = 0.0
            for axis in range(3):
                along += record.axes[step, side, axis] * towards[axis]
            shown[step, side] = pull * along
        if step + 1 < len(record.apparent):
            move(towards, turning, free, record.apparent, step, kick, swinging.time_step)
    return shown.flatten()


@njit(cache=True)
def _start(off: Array, resting: Array, sides: Array, pace: float) -> tuple[Array, Array]:
    """Return direction, and rate in 1/s, of a cable that is deviated from rest, (3,) each.

    Args:
        off: two angles, rad, and two rates relative to the natural frequency, (4,).
        resting: direction at rest, unit, (3,).
        sides: two directions across it, (2, 3).
        pace: natural frequency, rad/s.
    """
    towards = resting + off[0] * sides[0] + off[1] * sides[1]
    towards /= sqrt((towards * towards).sum())
    turning = pace * (off[2] * sides[0] + off[3] * sides[1])
    return towards, turning - (turning * towards).sum() * towards
