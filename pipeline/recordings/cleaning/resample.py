"""Resampling to a uniform time step, with interpolation over short gaps only."""

import itertools

import numpy as np
from scipy.sparse import csr_array

from simgap.recordings.cleaning.channels import INPUTS, QUATERNIONS, SLOW
from simgap.recordings.cleaning.filling import Lost, fill
from simgap.recordings.cleaning.grid import Grid, grid_of
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.cleaning.table import ChannelTable
from simgap.recordings.cleaning.work import RunUnderCleaning

FIFTH_DIFFERENCE = (-1.0, 5.0, -10.0, 10.0, -5.0, 1.0)  # by which white noise is told from motion
_LEAST_KEPT = (
    1.0 / 12.0
)  # of a mean of two; on a grid finer than the recording there is nothing to tell it by
_ROUNDING_FACTOR = 1.0 + 1e-6
_LONG_LOSS = 20.0  # samples: beyond it nobody knows how many were lost
_DIGITS = 10  # of the time step, so that 0.0099999999 is 0.01


def typical_step(time: np.ndarray) -> float:
    """Return the time step of a run, s: the slope of its times over the sample numbers, lost samples included.

    A mean of the steps would accumulate the jitter at both ends of every loss.
    """
    steps = np.diff(time)
    median = float(np.quantile(steps, 0.5, method="lower"))  # one of the steps, however they scatter
    numbers = np.maximum(np.round(steps / median), 1.0)
    place = np.concatenate([[0.0], np.cumsum(numbers)])
    step = _common_slope(place, time, np.flatnonzero(numbers > _LONG_LOSS) + 1)
    return float(f"{step:.{_DIGITS}g}") if abs(step / median - 1.0) < 1e-2 else median


def _common_slope(place: np.ndarray, time: np.ndarray, begins: np.ndarray) -> float:
    """Return the least-squares slope of times over places, the same in all pieces, each with a start of its own.

    Args:
        place: (samples,).
        time: (samples,), s.
        begins: of the pieces after the first one.
    """
    product = square = 0.0
    for first, past in itertools.pairwise([0, *begins.tolist(), len(time)]):
        late, far = (values[first:past] - values[first:past].mean() for values in (time, place))
        product, square = product + float(far @ late), square + float(far @ far)
    return product / square


def split_at_gaps(run: RunUnderCleaning, max_gap: float) -> None:
    """Divide the stretches of a run at gaps wider than `max_gap` s."""
    step = np.diff(run.time)
    same = run.stretch[1:] == run.stretch[:-1]
    wide = same & (step > max_gap * _ROUNDING_FACTOR)
    for first in np.flatnonzero(wide):
        detail = f"at t = {run.time[first]:.6g} s"
        reason = "gap too wide to interpolate, run split"
        run.note("gaps", "", reason, 0, detail, seconds=float(step[first]))
    run.stretch = np.zeros(len(run.time), dtype=np.int32)
    np.cumsum(wide | ~same, out=run.stretch[1:])


def resample(run: RunUnderCleaning, time_step: float, settings: Cleaning) -> RunUnderCleaning:
    """Bring a run to one time step and interpolate what is missing.

    Measurements are interpolated linearly, attitudes by slerp. A command of a swerve drive or joint is held until the
    next: the command that acts for most of the coming step is taken, and in a gap the earlier one. If the recorded
    times follow no clock, the mean of the held commands over the coming step is taken. Samples that are on time stay
    unchanged. Nothing is extrapolated or interpolated over gaps longer than the limits of `settings`. A run whose times
    are uniform already is filled in its place.
    """
    grid = grid_of(run, time_step, settings.jitter)
    result = RunUnderCleaning(
        run.name,
        run.kind,
        grid.time,
        run.columns,
        run.table if grid.complete else ChannelTable.empty(len(run.columns)),
        grid.stretch,
        run.needed,
        time_step,
        cause=run.cause
        if grid.complete
        else np.zeros((len(grid.time), len(run.columns)), dtype=np.uint8, order="F"),
        changes=run.changes,
        remarks=run.remarks,
        reasons=run.reasons,
    )
    result.noise_kept = noise_kept(grid.recorded, grid.time) if grid.moved else 1.0
    _note_rows(run, result, grid)
    done: set[str] = set()
    lost: Lost | None = None
    for columns in (
        *(group for group in QUATERNIONS if run.has(group)),
        *([column] for column in run.columns),
    ):
        if not done & set(columns):
            limit = settings.max_slow_gap if columns[0] in SLOW else settings.max_gap
            lost = fill(run, result, grid, columns, max(limit, 1.5 * time_step), lost)
            done |= set(columns)
    result.filled = run.filled[grid.nearest]
    for place in run.index([column for column in INPUTS[run.kind] if column in run.needed]):
        result.filled |= result.cause[:, place] > 0
    return result


def noise_kept(recorded: np.ndarray, time: np.ndarray) -> float:
    """Return the share of white noise that a fifth difference still shows after linear interpolation.

    A mean of two samples has less noise than either. The loss is greatest at the highest frequencies, which a fifth
    difference measures; means over many samples keep their noise.

    Args:
        recorded: times of the samples, s.
        time: between them, those that are interpolated, evenly spaced, s.
    """
    right = np.clip(np.searchsorted(recorded, time), 1, len(recorded) - 1)
    share = np.clip((time - recorded[right - 1]) / (recorded[right] - recorded[right - 1]), 0.0, 1.0)
    rows = np.arange(len(time))
    weights = csr_array(
        (
            np.concatenate([1.0 - share, share]),
            (np.concatenate([rows, rows]), np.concatenate([right - 1, right])),
        ),
        shape=(len(time), len(recorded)),
    )
    count = len(time) - len(FIFTH_DIFFERENCE) + 1
    if count < 1:
        return 1.0
    differences = sum(c * weights[place : place + count] for place, c in enumerate(FIFTH_DIFFERENCE))
    shown = differences.multiply(differences).sum(axis=1) / np.square(FIFTH_DIFFERENCE).sum()
    return float(np.clip(np.median(shown), _LEAST_KEPT, 1.0))


def _note_rows(run: RunUnderCleaning, result: RunUnderCleaning, grid: Grid) -> None:
    difference = len(result.time) - len(run.time)
    if grid.moved:
        detail = f"from {len(run.time)} samples, typically every {run.time_step:.4g} s"
        reason = f"resampled to a step of {result.time_step:.4g} s"
        run.note("resample", "", reason, difference, detail, seconds=float(np.ptp(run.time)))
    else:
        run.note("resample", "", "samples missing in the recording", difference)
