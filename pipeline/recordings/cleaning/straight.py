"""Stretches that were filled with a straight line before import, such as an extrapolated end."""

from collections.abc import Sequence

import numpy as np

from simgap.recordings.cleaning.channels import BODY_RATE, MOTOR_COMMAND, MOTOR_SPEED, SPECIFIC_FORCE
from simgap.recordings.cleaning.work import RunUnderCleaning, stretches_of

# noisy measurements in flight; positions and program inputs may well be straight
_VECTORS = (BODY_RATE, SPECIFIC_FORCE, MOTOR_SPEED, MOTOR_COMMAND)
_BEND = 1e-2  # second difference over first, from sample to sample
_CHORD = 1e-4  # largest distance from the chord over the whole way


def erase_straight(run: RunUnderCleaning, max_gap: float) -> None:
    """Erase what is a straight line, in every component at once, for longer than `max_gap` s."""
    if run.kind != "quadrotor" or len(run.time) < 3:
        return
    same = run.stretch[1:] == run.stretch[:-1]
    longest = np.diff(run.time)[same].max(initial=0.0)
    # A line has more inner samples than this, so that one of every so many tells whether there may be any.
    every = max(1, int(max_gap / longest) - 1) if longest > 0.0 else 1
    for columns in _VECTORS:
        if run.has(columns):
            values = [run.column(name) for name in columns]
            rows = _straight(run.time, values, run.stretch, max_gap, every)
            run.erase(rows, columns, "straight", "straight line instead of measurements")


def _straight(
    time: np.ndarray, values: Sequence[np.ndarray], stretch: np.ndarray, max_gap: float, every: int
) -> np.ndarray:
    """Return the mask of samples inside made-up stretches, (samples,); one of `every` samples tells of each."""
    result = np.zeros(len(time), dtype=bool)
    told = np.arange(every, len(time) - 1, every)
    told = told[_unbent(told, time, values, stretch)]
    if not len(told):
        return result
    beside = np.zeros(len(time) + every, dtype=np.int8)
    beside[told - every + 1] += 1
    beside[told + every] -= 1
    rows = np.flatnonzero(np.cumsum(beside, dtype=np.int8)[1 : len(time) - 1]) + 1
    straight = np.zeros(len(time), dtype=bool)
    straight[rows] = _unbent(rows, time, values, stretch)
    lines = stretches_of(straight) - np.array([1, 0])  # the neighbours lie on the line too
    lines = lines[np.diff(time[lines])[:, 0] > max_gap]
    for first, last in lines[_on_chord(lines, time, values)]:
        result[first + 1 : last + 1] = True
    return result


def _unbent(
    rows: np.ndarray, time: np.ndarray, values: Sequence[np.ndarray], stretch: np.ndarray
) -> np.ndarray:
    """Return which samples lie on a line with their neighbours, of which two components move, (rows,)."""
    inside = stretch[rows + 1] == stretch[rows - 1]
    before, behind = time[rows] - time[rows - 1], time[rows + 1] - time[rows]
    moving = np.zeros(len(rows), dtype=np.int8)
    for column in values:
        here = column[rows]
        slope = (column[rows + 1] - here) / behind
        bend = slope - (here - column[rows - 1]) / before
        size = np.abs(slope)
        inside &= np.abs(bend) <= _BEND * size
        moving += size > 0
    return np.asarray(inside & (moving >= 2))


def _on_chord(lines: np.ndarray, time: np.ndarray, values: Sequence[np.ndarray]) -> np.ndarray:
    """Return of which lines, rows of their first and last samples, all samples lie on the chord, (lines,)."""
    first, last = lines.T
    lengths = last - first + 1
    begins = np.cumsum(lengths) - lengths
    line = np.repeat(np.arange(len(lines)), lengths)
    rows = np.arange(len(line)) + (first - begins)[line]
    share = (time[rows] - time[first][line]) / (time[last] - time[first])[line]
    result = np.ones(len(lines), dtype=bool)
    for column in values if len(lines) else ():
        way = column[last] - column[first]
        off = np.abs(column[rows] - column[first][line] - share * way[line])
        result &= np.maximum.reduceat(off, begins) <= _CHORD * np.abs(way)
    return result
