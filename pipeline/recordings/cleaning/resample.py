"""Resampling to a uniform time step, with interpolation over short gaps only."""

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from scipy.sparse import csr_array

from simgap.recordings.cleaning.channels import ANGLES, INPUTS, QUATERNIONS, SLOW
from simgap.recordings.cleaning.quaternions import slerp
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.cleaning.work import RunUnderCleaning

FIFTH_DIFFERENCE = (-1.0, 5.0, -10.0, 10.0, -5.0, 1.0)  # by which white noise is told from motion
_LEAST_KEPT = (
    1.0 / 12.0
)  # of a mean of two; on a grid finer than the recording there is nothing to tell it by
_SAME = 1e-6  # of a time step: times this close are the same
_EQUAL = 1e-4  # of a time step: recorded times this close to the grid are taken as they are
_ROUNDING_FACTOR = 1.0 + 1e-6
_NEAR = 0.5 * _ROUNDING_FACTOR  # time steps: a value this close to a measured one is as good as measured
_SAME_STEP = 1e-3  # relative
_FEW_SAMPLES = 10  # samples, of which nobody can say whether they follow a clock
_WANDERING = 0.5  # of the ratio that independent deviations from a clock's ticks have
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


@dataclass
class _Grid:
    """The new times and their relation to the recorded ones.

    Attributes:
        time: new times, s, shape (new samples,).
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
    recorded: np.ndarray
    stretch: np.ndarray
    moved: bool
    complete: bool
    last: np.ndarray
    exact: np.ndarray
    nearest: np.ndarray
    present: np.ndarray
    ticking: bool


def resample(run: RunUnderCleaning, time_step: float, settings: Cleaning) -> RunUnderCleaning:
    """Bring a run to one time step and interpolate what is missing.

    Measurements are interpolated linearly, attitudes by slerp. A command of a swerve drive or joint is held until the
    next: the command that acts for most of the coming step is taken, and in a gap the earlier one. If the recorded
    times follow no clock, the mean of the held commands over the coming step is taken. Samples that are on time stay
    unchanged. Nothing is extrapolated or interpolated over gaps longer than the limits of `settings`. A run whose times
    are uniform already is filled in its place.
    """
    grid = _grid(run, time_step, settings.jitter)
    result = RunUnderCleaning(
        run.name,
        run.kind,
        grid.time,
        run.columns,
        run.values if grid.complete else np.zeros((len(grid.time), len(run.columns)), order="F"),
        grid.stretch,
        run.needed,
        time_step,
        changes=run.changes,
        remarks=run.remarks,
        reasons=run.reasons,
    )
    if grid.complete:
        result.cause = run.cause
    result.noise_kept = noise_kept(grid.recorded, grid.time) if grid.moved else 1.0
    _note_rows(run, result, grid)
    done: set[str] = set()
    for columns in (
        *(group for group in QUATERNIONS if run.has(group)),
        *([column] for column in run.columns),
    ):
        if not done & set(columns):
            limit = settings.max_slow_gap if columns[0] in SLOW else settings.max_gap
            _fill(run, result, grid, columns, max(limit, 1.5 * time_step))
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


def _grid(run: RunUnderCleaning, time_step: float, jitter: float) -> _Grid:
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
        last = np.searchsorted(recorded, new + _SAME * time_step, side="right") - 1
        nearest = _nearest(recorded, new)
    return _Grid(
        time=new,
        recorded=recorded,
        stretch=np.repeat(np.arange(len(pieces), dtype=np.int32), [len(time) for time, _, _ in pieces]),
        moved=moved,
        complete=complete,
        last=last,
        exact=np.abs(recorded[last] - new) <= _SAME * time_step,
        nearest=nearest,
        present=np.abs(recorded[nearest] - new) <= _NEAR * run.time_step,
        ticking=not moved or all(_is_ticking(part, run.time_step) for part in parts),
    )


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


def _note_rows(run: RunUnderCleaning, result: RunUnderCleaning, grid: _Grid) -> None:
    difference = len(result.time) - len(run.time)
    if grid.moved:
        detail = f"from {len(run.time)} samples, typically every {run.time_step:.4g} s"
        reason = f"resampled to a step of {result.time_step:.4g} s"
        run.note("resample", "", reason, difference, detail, seconds=float(np.ptp(run.time)))
    else:
        run.note("resample", "", "samples missing in the recording", difference)


def _fill(
    run: RunUnderCleaning, result: RunUnderCleaning, grid: _Grid, columns: list[str], limit: float
) -> None:
    places = run.index(columns)
    known = np.logical_and.reduce([np.isfinite(run.values[:, place]) for place in places])
    if not known.any():
        result.values[:, places] = np.nan
        result.cause[:, places] = result.number("missing")
        return
    if grid.complete and known.all():
        result.cause[:, places] = 0
        return
    times, values, is_input = grid.recorded, run.values[:, places], columns[0] in INPUTS[run.kind]
    measured = known if grid.complete else grid.exact & known[grid.last]
    new = np.where(measured[:, None], values if grid.complete else values[grid.last], np.nan)
    rows, left, right = _beside(np.flatnonzero(~measured), known, run.stretch, grid)
    near = times[right] - times[left] <= limit + _SAME * result.time_step
    rows, left, right = rows[near], left[near], right[near]
    before, ahead = grid.time[rows] - times[left], times[right] - grid.time[rows]
    share = before / (times[right] - times[left])
    if is_input:
        share = _next_acts(share, ahead, run.time_step)
    new[rows] = _between(run.kind, columns, values[left], values[right], share)
    if is_input and not grid.ticking:
        held = measured.copy()
        held[rows] = True
        new[held] = mean_of_held(times[known], values[known], grid.time[held], result.time_step)
    result.values[:, places] = new
    filled = np.zeros(len(new), dtype=bool)
    filled[rows] = np.minimum(before, ahead) > _NEAR * run.time_step
    _note_filled(run, result, grid, columns, filled)


def _beside(
    rows: np.ndarray, known: np.ndarray, stretch: np.ndarray, grid: _Grid
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which new times lie between two known samples of their stretch, and the numbers of the two.

    Args:
        rows: of the new times that are looked at.
        known: whether a recorded sample is known, (samples,).
        stretch: of the recorded samples, (samples,).
        grid: the new times.
    """
    numbers = np.flatnonzero(known)
    place = np.cumsum(known)[grid.last[rows]] - 1
    inside = (place >= 0) & (place < len(numbers) - 1)
    rows, place = rows[inside], place[inside]
    left, right = numbers[place], numbers[place + 1]
    same = (stretch[left] == stretch[right]) & (stretch[left] == grid.stretch[rows])
    return rows[same], left[same], right[same]


def _next_acts(share: np.ndarray, ahead: np.ndarray, own_step: float) -> np.ndarray:
    """Return 1 where the next command acts for most of the coming step, else 0: the earlier one does.

    Args:
        share: of the way from the earlier command to the next.
        ahead: time until the next command, s.
        own_step: of the recording, s.
    """
    return ((share > 0.5) & (ahead <= _NEAR * own_step)).astype(np.float64)


def mean_of_held(times: np.ndarray, values: np.ndarray, starts: np.ndarray, time_step: float) -> np.ndarray:
    """Return the mean over the step that follows each start of what is held from one time to the next.

    Where commands come at any time within a step, whichever of two acts for longer, its impulse alone would be wrong.

    Args:
        times: of the commands, s.
        values: (commands, columns).
        starts: of the steps, s.
        time_step: s.
    """
    impulse = np.cumsum(np.diff(times, prepend=times[0])[:, None] * np.roll(values, 1, axis=0), axis=0)

    def until(time: np.ndarray) -> np.ndarray:
        last = np.clip(np.searchsorted(times, time, side="right") - 1, 0, None)
        return impulse[last] + (time - times[last])[:, None] * values[last]

    return (until(starts + time_step) - until(starts)) / time_step


def _between(
    kind: str, columns: list[str], left: np.ndarray, right: np.ndarray, share: np.ndarray
) -> np.ndarray:
    if columns in QUATERNIONS:
        return slerp(left, right, share)
    way = right - left
    if columns[0] in ANGLES:
        way = np.remainder(way + np.pi, 2 * np.pi) - np.pi
    return left + share[:, None] * way


def _note_filled(
    run: RunUnderCleaning, result: RunUnderCleaning, grid: _Grid, columns: list[str], filled: np.ndarray
) -> None:
    """Record, per channel, which values were filled or remain missing, and why."""
    for column in columns:
        place = run.columns.index(column)
        wanting = np.flatnonzero(filled | np.isnan(result.values[:, place]))
        cause = np.where(grid.present[wanting], run.cause[grid.nearest[wanting], place], 0)
        cause[cause == 0] = run.number("absent")
        result.cause[:, place] = 0
        result.cause[wanting, place] = cause
        how = "earlier value kept" if column in INPUTS[run.kind] else "interpolated"
        counts = np.bincount(cause[filled[wanting]], minlength=len(run.reasons))
        for reason, count in sorted(zip(run.reasons, counts.tolist(), strict=True)):
            run.note("fill", column, f"{how} ({reason})", count)
