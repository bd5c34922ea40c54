"""Stretches that were filled with a straight line before import, such as an extrapolated end."""

import numpy as np

from simgap.recordings.cleaning.channels import BODY_RATE, MOTOR_COMMAND, MOTOR_SPEED, SPECIFIC_FORCE
from simgap.recordings.cleaning.work import RunUnderCleaning, stretches_of

# noisy measurements in flight; positions and program inputs may well be straight
_VECTORS = (BODY_RATE, SPECIFIC_FORCE, MOTOR_SPEED, MOTOR_COMMAND)
_BEND = 1e-2  # second difference over first, from sample to sample
_CHORD = 1e-4  # largest distance from the chord over the whole way


def erase_straight(run: RunUnderCleaning, max_gap: float) -> None:
    """Erase what is a straight line, in every component at once, for longer than `max_gap` s."""
    if run.kind != "quadrotor":
        return
    for columns in _VECTORS:
        if run.has(columns):
            rows = _straight(run.time, run.channel(*columns), run.stretch, max_gap)
            run.erase(rows, columns, "straight", "straight line instead of measurements")


def _straight(time: np.ndarray, values: np.ndarray, stretch: np.ndarray, max_gap: float) -> np.ndarray:
    """Return the mask of samples inside made-up stretches, shape (samples,)."""
    result = np.zeros(len(time), dtype=bool)
    if len(time) < 3:
        return result
    inside = stretch[2:] == stretch[:-2]
    time_step, moving = np.diff(time), np.zeros(len(inside), dtype=np.int8)
    for column in values.T:
        slope = np.diff(column) / time_step
        size = np.abs(slope[1:])
        with np.errstate(invalid="ignore"):
            inside &= np.abs(np.diff(slope)) <= _BEND * size
            moving += size > 0
    straight = np.concatenate([[False], inside & (moving >= 2), [False]])
    lines = stretches_of(straight) - np.array([1, 0])  # the neighbours lie on the line too
    for first, last in lines[np.diff(time[lines])[:, 0] > max_gap]:
        if _on_chord(time[first : last + 1], values[first : last + 1]):
            result[first + 1 : last + 1] = True
    return result


def _on_chord(time: np.ndarray, values: np.ndarray) -> bool:
    share = ((time - time[0]) / (time[-1] - time[0]))[:, None]
    way = values[-1] - values[0]
    return bool((np.abs(values - values[0] - share * way).max(axis=0) <= _CHORD * np.abs(way)).all())
