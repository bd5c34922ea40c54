"""What is missing at uniform times: interpolated between the samples beside it, or held."""

from dataclasses import dataclass

import numpy as np

from simgap.recordings.cleaning.channels import ANGLES, INPUTS, QUATERNIONS
from simgap.recordings.cleaning.grid import NEAR, SAME, Grid
from simgap.recordings.cleaning.quaternions import slerp
from simgap.recordings.cleaning.work import RunUnderCleaning, stretches_of


@dataclass
class Lost:
    """What is not measured of a channel, and what it is interpolated between.

    Attributes:
        known: whether a recorded sample is known, (samples,).
        limit: longest time that is interpolated, s.
        absent: the new times at which nothing was measured, in order.
        rows: those of them that are interpolated.
        left: the recorded sample before each of these.
        right: the recorded sample behind it.
        share: of the way from the one to the other.
        ahead: time until the one behind, s.
        filled: whether a new time is so far from both that its value is made up, (new samples,).
    """

    known: np.ndarray
    limit: float
    absent: np.ndarray
    rows: np.ndarray
    left: np.ndarray
    right: np.ndarray
    share: np.ndarray
    ahead: np.ndarray
    filled: np.ndarray


def fill(
    run: RunUnderCleaning,
    result: RunUnderCleaning,
    grid: Grid,
    columns: list[str],
    limit: float,
    last: Lost | None,
) -> Lost | None:
    """Fill channels; return what they lack, which the next ones often lack as well: one message brings them all."""
    places = run.index(columns)
    known = np.logical_and.reduce([np.isfinite(run.table.arrays[place]) for place in places])
    if not known.any():
        for place in places:
            result.table.put(place, np.full(len(grid.time), np.nan))
        result.cause[:, places] = result.number("missing")
        return last
    if grid.complete and known.all():
        result.cause[:, places] = 0
        return last
    alike = last is not None and last.limit == limit and np.array_equal(last.known, known)
    lost = last if last is not None and alike else _lost(run, grid, known, limit)
    rows, share = lost.rows, lost.share
    if columns[0] in INPUTS[run.kind]:
        share = _next_acts(share, lost.ahead, run.time_step)
    new = _between(columns, run.rows(lost.left, columns), run.rows(lost.right, columns), share)
    if columns[0] in INPUTS[run.kind] and not grid.ticking:
        measured = np.setdiff1d(np.arange(len(grid.time)), lost.absent, assume_unique=True)
        rows = np.sort(np.concatenate([measured, rows]))
        times, commands = grid.recorded[known], run.rows(known, columns)
        new = mean_of_held(times, commands, grid.time[rows], result.time_step)
    for number, place in enumerate(places):
        if not grid.complete:
            result.table.put(place, run.table.arrays[place][grid.last])
        values = result.table.own(place)
        values[lost.absent] = np.nan
        values[rows] = new[:, number]
    _note_filled(run, result, grid, columns, lost)
    return lost


def _lost(run: RunUnderCleaning, grid: Grid, known: np.ndarray, limit: float) -> Lost:
    """Return what is lost where so much of a channel is known."""
    times = grid.recorded
    absent = np.flatnonzero(~(known if grid.complete else grid.exact & known[grid.last]))
    rows, left, right = _beside(absent, known, run.stretch, grid)
    near = times[right] - times[left] <= limit + SAME * grid.time_step
    rows, left, right = rows[near], left[near], right[near]
    before, ahead = grid.time[rows] - times[left], times[right] - grid.time[rows]
    filled = np.zeros(len(grid.time), dtype=bool)
    filled[rows] = np.minimum(before, ahead) > NEAR * run.time_step
    share = before / (times[right] - times[left])
    return Lost(known, limit, absent, rows, left, right, share, ahead, filled)


def _beside(
    rows: np.ndarray, known: np.ndarray, stretch: np.ndarray, grid: Grid
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which new times lie between two known samples of their stretch, and the numbers of the two.

    Args:
        rows: of the new times that are looked at.
        known: whether a recorded sample is known, (samples,).
        stretch: of the recorded samples, (samples,).
        grid: the new times.
    """
    unknown = np.flatnonzero(~known)
    first, past = stretches_of(~known).T
    # By sample: the last known one up to it, and the first one from there on.
    before = np.arange(len(known) + 1)
    after = before.copy()
    before[unknown], after[unknown] = (np.repeat(side, past - first) for side in (first - 1, past))
    left = before[grid.last[rows]]
    right = after[left + 1]
    inside = (left >= 0) & (right < len(known))
    rows, left, right = rows[inside], left[inside], right[inside]
    same = (stretch[left] == stretch[right]) & (stretch[left] == grid.stretch[rows])
    return rows[same], left[same], right[same]


def _next_acts(share: np.ndarray, ahead: np.ndarray, own_step: float) -> np.ndarray:
    """Return 1 where the next command acts for most of the coming step, else 0: the earlier one does.

    Args:
        share: of the way from the earlier command to the next.
        ahead: time until the next command, s.
        own_step: of the recording, s.
    """
    return ((share > 0.5) & (ahead <= NEAR * own_step)).astype(np.float64)


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


def _between(columns: list[str], left: np.ndarray, right: np.ndarray, share: np.ndarray) -> np.ndarray:
    if columns in QUATERNIONS:
        return slerp(left, right, share)
    way = right - left
    if columns[0] in ANGLES:
        way = np.remainder(way + np.pi, 2 * np.pi) - np.pi
    return left + share[:, None] * way


def _note_filled(
    run: RunUnderCleaning,
    result: RunUnderCleaning,
    grid: Grid,
    columns: list[str],
    lost: Lost,
) -> None:
    """Record, per channel, which values were filled or remain missing, of those that were not measured, and why."""
    absent, filled = lost.absent, lost.filled[lost.absent]
    for column in columns:
        place = run.columns.index(column)
        wanting = filled | np.isnan(result.table.arrays[place][absent])
        rows = absent[wanting]
        cause = np.where(grid.present[rows], run.cause[grid.nearest[rows], place], 0)
        cause[cause == 0] = run.number("absent")
        result.cause[:, place] = 0
        result.cause[rows, place] = cause
        how = "earlier value kept" if column in INPUTS[run.kind] else "interpolated"
        counts = np.bincount(cause[filled[wanting]], minlength=len(run.reasons))
        for reason, count in sorted(zip(run.reasons, counts.tolist(), strict=True)):
            run.note("fill", column, f"{how} ({reason})", count)
