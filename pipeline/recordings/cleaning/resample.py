"""A uniform time step, and what is missing filled as far as that is honest."""

import itertools
from dataclasses import dataclass

import numpy as np

from pipeline.recordings.cleaning.channels import ANGLES, INPUTS, QUATERNIONS, SLOW
from pipeline.recordings.cleaning.quaternions import slerp
from pipeline.recordings.cleaning.settings import Cleaning
from pipeline.recordings.cleaning.work import RunUnderCleaning

_EQUAL = 1e-4  # of a time step: recorded times this close to the grid are taken as they are
_SAME_STEP = 1e-3  # relative
_DIGITS = 10  # of the time step, so that 0.0099999999 is 0.01


def typical_step(time: np.ndarray) -> float:
    """Return the time step of a run: the mean of the steps near the median, s."""
    steps = np.diff(time)
    median = float(np.median(steps))
    step = float(steps[np.abs(steps - median) < 0.5 * median].mean())
    return float(f"{step:.{_DIGITS}g}") if abs(step / median - 1.0) < 1e-2 else median


def split_at_gaps(time: np.ndarray, segment: np.ndarray | None, max_gap: float) -> np.ndarray:
    """Number the stretches between gaps wider than `max_gap` s (and between segments that were there
    before)."""
    begins = np.diff(time) > max_gap
    if segment is not None:
        begins |= np.diff(segment) != 0
    return np.concatenate([[0], np.cumsum(begins)]).astype(np.int64)


@dataclass
class _Grid:
    """The new times, the recorded times as far as they are moved onto it, and the stretch of each new
    time."""

    time: np.ndarray
    recorded: np.ndarray
    stretch: np.ndarray
    moved: bool


def resample(run: RunUnderCleaning, time_step: float, settings: Cleaning) -> RunUnderCleaning:
    """Bring a run to one time step and interpolate what is missing.

    Measurements are interpolated linearly, attitudes by slerp, the inputs of swerve and joint keep the
    earlier value. Recorded samples that are on time stay untouched. Nothing is extrapolated, and nothing is
    interpolated between samples farther apart than the limits of `settings`.
    """
    grid = _grid(run, time_step, settings.jitter)
    result = RunUnderCleaning(
        run.name,
        run.kind,
        grid.time,
        run.columns,
        np.full((len(grid.time), len(run.columns)), np.nan),
        grid.stretch,
        run.needed,
        time_step,
    )
    result.changes = run.changes
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
    return result


def _grid(run: RunUnderCleaning, time_step: float, jitter: float) -> _Grid:
    edges = [0, *(np.flatnonzero(np.diff(run.stretch)) + 1), len(run.time)]
    parts = [run.time[first:past] for first, past in itertools.pairwise(edges)]
    pieces = [_piece(part, time_step, run.time_step, jitter) for part in parts]
    return _Grid(
        np.concatenate([time for time, _, _ in pieces]),
        np.concatenate([recorded for _, recorded, _ in pieces]),
        np.concatenate([np.full(len(time), number) for number, (time, _, _) in enumerate(pieces)]),
        any(moved for _, _, moved in pieces),
    )


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
        run.note("resample", "", "samples absent from the recording", difference)
    for number in np.unique(run.stretch)[1:]:
        first = int(np.argmax(run.stretch == number))
        gap = float(run.time[first] - run.time[first - 1])
        run.note(
            "gaps", "", "gap too wide to interpolate, run split", 0, f"at t = {run.time[first]:.6g} s", gap
        )


def _fill(
    run: RunUnderCleaning, result: RunUnderCleaning, grid: _Grid, columns: list[str], limit: float
) -> None:
    places = run.index(columns)
    values = run.values[:, places]
    known = np.flatnonzero(np.isfinite(values).all(axis=1))
    if not len(known):
        return
    times, values = grid.recorded[known], values[known]
    tolerance = 1e-6 * result.time_step
    left = np.clip(np.searchsorted(times, grid.time + tolerance, side="right") - 1, 0, None)
    right = np.clip(left + 1, None, len(times) - 1)
    exact = np.abs(times[left] - grid.time) <= tolerance
    stretch = run.stretch[known]
    between = (times[left] <= grid.time) & (times[right] >= grid.time) & (stretch[left] == stretch[right])
    between &= (stretch[left] == grid.stretch) & (times[right] - times[left] <= limit + tolerance) & ~exact
    share = (grid.time - times[left])[between] / (times[right] - times[left])[between]
    new = np.full((len(grid.time), len(places)), np.nan)
    new[exact] = values[left[exact]]
    new[between] = _between(run.kind, columns, values[left[between]], values[right[between]], share)
    result.values[:, places] = new
    _note_filled(run, result, grid, columns, between)


def _between(
    kind: str, columns: list[str], left: np.ndarray, right: np.ndarray, share: np.ndarray
) -> np.ndarray:
    if columns in QUATERNIONS:
        return slerp(left, right, share)
    if columns[0] in INPUTS[kind]:
        return left
    way = right - left
    if columns[0] in ANGLES:
        way = np.remainder(way + np.pi, 2 * np.pi) - np.pi
    return left + share[:, None] * way


def _note_filled(
    run: RunUnderCleaning, result: RunUnderCleaning, grid: _Grid, columns: list[str], between: np.ndarray
) -> None:
    nearest = np.clip(np.searchsorted(grid.recorded, grid.time), 0, len(run.time) - 1)
    present = np.abs(grid.recorded[nearest] - grid.time) <= 1e-6 * result.time_step
    for column in columns:
        place = run.columns.index(column)
        cause = np.where(present, run.cause[nearest, place], "resampled" if grid.moved else "absent")
        result.cause[:, place] = np.where(between | np.isnan(result.values[:, place]), cause, "")
        held = column in INPUTS[run.kind]
        how = "earlier value kept" if held else "interpolated"
        for reason in sorted(set(cause[between])) if not grid.moved else ():
            run.note("fill", column, f"{how} ({reason})", int((cause[between] == reason).sum()))
