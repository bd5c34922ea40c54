"""The uniform times of a run, and how the recorded ones lie on them."""

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from simgap.recordings.cleaning.work import RunUnderCleaning

NEAR = 0.5 * (1.0 + 1e-6)  # time steps: a value this close to a measured one is as good as measured
SAME = 1e-6  # of a time step: times this close are the same
_EQUAL = 1e-4  # of a time step: recorded times this close to the grid are taken as they are
_SAME_STEP = 1e-3  # relative
_FEW_SAMPLES = 10  # samples, of which nobody can say whether they follow a clock
_WANDERING = 0.5  # of the ratio that independent deviations from a clock's ticks have


@dataclass
class Grid:
    """The new times and their relation to the recorded ones.

    Attributes:
        time: new times, s, shape (new samples,).
        time_step: between them, s.
        recorded: recorded times as far as they are moved onto the grid, s, shape (samples,).
        stretch: the stretch of each new time.
        moved: whether recorded times are off the grid.
        complete: whether every new time is a recorded one, and every recorded one is there.
        last: number of the last recorded time before or at each new one.
        exact: whether that is at it.
        nearest: the recorded sample nearest to each new time.
        present: whether that is within half a time step.
        ticking: whether recorded times off the grid scatter about the ticks of a clock; else they drift.
    """

    time: np.ndarray
    time_step: float
    recorded: np.ndarray
    stretch: np.ndarray
    moved: bool
    complete: bool
    last: np.ndarray
    exact: np.ndarray
    nearest: np.ndarray
    present: np.ndarray
    ticking: bool


def grid_of(run: RunUnderCleaning, time_step: float, jitter: float) -> Grid:
    """Return the uniform times of a run.

    Args:
        run: as recorded.
        time_step: of the uniform times, s.
        jitter: of a time step; recorded times that scatter by up to so much are moved onto their ticks.
    """
    edges = [0, *(np.flatnonzero(np.diff(run.stretch)) + 1), len(run.time)]
    parts = [run.time[first:past] for first, past in itertools.pairwise(edges)]
    pieces = [_piece(part, time_step, run.time_step, jitter) for part in parts]
    new = _joined([time for time, _, _ in pieces])
    recorded = _joined([recorded for _, recorded, _ in pieces])
    moved = any(moved for _, _, moved in pieces)
    complete = not moved and np.array_equal(new, recorded)
    if complete:
        last = nearest = np.arange(len(new))
    else:
        last = np.searchsorted(recorded, new + SAME * time_step, side="right") - 1
        nearest = _nearest(recorded, new)
    return Grid(
        time=new,
        time_step=time_step,
        recorded=recorded,
        stretch=np.repeat(np.arange(len(pieces), dtype=np.int32), [len(time) for time, _, _ in pieces]),
        moved=moved,
        complete=complete,
        last=last,
        exact=_all(new) if complete else np.abs(recorded[last] - new) <= SAME * time_step,
        nearest=nearest,
        present=_all(new) if complete else np.abs(recorded[nearest] - new) <= NEAR * run.time_step,
        ticking=not moved or all(_is_ticking(part, run.time_step) for part in parts),
    )


def _all(samples: np.ndarray) -> np.ndarray:
    return np.ones(len(samples), dtype=bool)


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _nearest(recorded: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Return the number of the recorded time that is nearest to each new one."""
    after = np.clip(np.searchsorted(recorded, new), 1, max(1, len(recorded) - 1)) % len(recorded)
    return np.where(new - recorded[after - 1] < recorded[after] - new, after - 1, after)


def _is_ticking(time: np.ndarray, own_step: float) -> bool:
    """Whether times scatter about evenly spaced ticks independently, by von Neumann's ratio.

    Of independent deviations, successive ones differ by twice their variance in the mean square; of deviations that
    add up, by far less. Source: von Neumann 1941, Distribution of the ratio of the mean square successive difference
    to the variance (Annals of Mathematical Statistics 12).
    """
    if len(time) < _FEW_SAMPLES:
        return True
    ticks = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(np.diff(time) / own_step), 1.0))])
    late = Polynomial.fit(ticks, time, 1)(ticks) - time
    if np.ptp(late) <= _EQUAL * own_step:
        return True
    return bool(np.square(np.diff(late)).mean() > _WANDERING * 2.0 * late.var())


def _piece(
    time: np.ndarray, time_step: float, own_step: float, jitter: float
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Return the grid of one stretch, its recorded times as they lie on it, and whether they were off it."""
    place = np.round((time - time[0]) / time_step)
    late = time - (time[0] + place * time_step)
    if np.abs(late).max() <= _EQUAL * time_step and len(time) == place[-1] + 1:
        return time, time, False
    if abs(own_step / time_step - 1.0) < _SAME_STEP:  # two clocks that call the same step by another name
        place = np.round((time - time[0]) / own_step)
        late = time - (time[0] + place * own_step)
    if np.ptp(late) <= 2.0 * jitter * time_step and (np.diff(place) > 0).all():
        uniform = time[0] + np.arange(int(place[-1]) + 1) * time_step
        return uniform, uniform[place.astype(int)], False
    count = int(np.floor((time[-1] - time[0]) / time_step + 1e-9)) + 1
    return time[0] + np.arange(count) * time_step, time, True
