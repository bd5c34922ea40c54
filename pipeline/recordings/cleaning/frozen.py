"""Samples that were repeated because no newer message arrived, although the machine moved."""

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.spatial.transform import Rotation

from simgap.recordings.cleaning.channels import ATTITUDE, COMMANDS, RATES, SPECIFIC_FORCE, telegrams
from simgap.recordings.cleaning.work import RunUnderCleaning, stretches_of

_COINCIDENCE_LEVEL = 0.01  # a repetition likelier than this may be a coincidence
_CHANGES_AROUND = 11  # changes over which the usual step is taken
_LOW_RATE = 0.5  # share of repetitions above which the channel is simply logged less often
_STANDSTILL_SHARE = 1e-3  # of a channel's largest value: below, it stands still
_EQUAL_SHARE = 1e-9
_EQUAL_SIZE = 4.0 * _EQUAL_SHARE  # of vectors whose components are equal to that share of the largest


def erase_frozen(run: RunUnderCleaning, max_gap: float) -> None:
    """Erase repetitions of a whole message that cannot be chance.

    A quantised channel repeats by chance when it moves by less than its quantum q per sample; with the usual
    step s around the repetition the chance is about q / 2s per channel, and the product over the channels of
    a message. Standstill (all rates zero), commands at their limits or constant for over `max_gap` s, and
    channels logged at a lower rate are left.
    """
    for columns in telegrams(run.kind, run.columns):
        repeated = _repeated(run, columns)
        if columns == SPECIFIC_FORCE and run.has(ATTITUDE):
            repeated |= _repeated_in_world(run)
        if not repeated.any():
            continue
        values = [run.column(column) for column in columns]
        known = np.logical_and.reduce([np.isfinite(column) for column in values])
        if known.sum() < 3 * _CHANGES_AROUND:
            continue
        moving = ~_at_rest(run, columns, values) & known
        rows = _unlikely(values, repeated, moving)
        if set(columns) <= COMMANDS:
            rows = _shorter(rows, run.time, max_gap)
        name = columns[0].rsplit("_", 1)[0]
        share = rows.sum() / max(1, moving.sum())
        if share > _LOW_RATE:
            run.note("frozen", name, "logged at a lower rate, kept", 0, f"{share:.0%} repeat", seconds=0.0)
        else:
            longest = np.diff(stretches_of(rows)).max(initial=0)
            run.erase(
                rows,
                columns,
                "frozen",
                "last value repeated, no newer message",
                f"at most {longest} in a row",
            )


def _shorter(mask: np.ndarray, time: np.ndarray, longest: float) -> np.ndarray:
    """Keep the stretches of a mask that last up to `longest` s."""
    stretches = stretches_of(mask)
    first, past = stretches.T
    short = time[past - 1] - time[first - 1] <= longest
    result = np.zeros(len(mask), dtype=bool)
    result[mask] = np.repeat(short, past - first)
    return result


def _repeated(run: RunUnderCleaning, columns: list[str]) -> np.ndarray:
    """Return which samples repeat the last one in every column."""
    same = run.stretch[1:] == run.stretch[:-1]
    for column in columns:
        if not same.any():
            break
        values = run.column(column)
        same &= values[1:] == values[:-1]
    return np.concatenate([[False], same])


def _repeated_in_world(run: RunUnderCleaning) -> np.ndarray:
    """Find held accelerations of loggers that turn them into world axes: held there, they move in body
    axes."""
    size = run.length(SPECIFIC_FORCE)
    with np.errstate(invalid="ignore"):  # a rotation keeps the size, so that others need not be turned
        alike = np.abs(np.diff(size)) <= _EQUAL_SIZE * size[1:]
    rows = 1 + np.flatnonzero(alike & (run.stretch[1:] == run.stretch[:-1]))
    for at in (0, 1):
        rows = rows[np.isfinite(run.rows(rows - at, ATTITUDE)).all(axis=1)]
    result = np.zeros(len(size), dtype=bool)
    if len(rows):
        before, after = (
            Rotation.from_quat(run.rows(at, ATTITUDE), scalar_first=True).apply(run.rows(at, SPECIFIC_FORCE))
            for at in (rows - 1, rows)
        )
        close = np.abs(after - before).max(axis=1) <= _EQUAL_SHARE * np.abs(after).max(axis=1)
        result[rows[close]] = True
    return result


def _unlikely(values: Sequence[np.ndarray], repeated: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Return which repetitions are too unlikely, of those in motion, shape (samples,)."""
    result = np.zeros(len(repeated), dtype=bool)
    again, newer = np.flatnonzero(repeated), np.flatnonzero(~repeated)
    numbers = np.flatnonzero(moving[again])
    judged, steps = again[numbers], len(newer) - 1
    if steps < 1 or not len(judged):
        return result
    before = judged - numbers - 1  # of the newer samples, the one that is repeated
    beside = np.clip([before - 1, before], 0, steps - 1)
    wanted, chance = np.zeros(steps, dtype=bool), np.ones(steps)
    wanted[beside] = True
    places = np.flatnonzero(wanted)
    for column in values:
        if not len(places):
            break
        chance[places] *= _chances(np.abs(np.diff(np.take(column, newer))), places)
        places = places[chance[places] >= _COINCIDENCE_LEVEL]  # no other channel makes it likelier again
    likelier = chance[beside].max(axis=0)  # of the two steps beside
    result[judged] = likelier < _COINCIDENCE_LEVEL
    return result


def _chances(step: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the chance that the next sample of a channel is the same, at some of the steps between fresh samples."""
    quantum = np.where(step > 0, step, np.inf).min()
    if not np.isfinite(quantum):
        return np.ones(len(places))
    step[np.isnan(step)] = 0.0
    windows = sliding_window_view(np.pad(step, _CHANGES_AROUND // 2, mode="edge"), _CHANGES_AROUND)[places]
    windows.partition(_CHANGES_AROUND // 2, axis=1)
    usual = windows[:, _CHANGES_AROUND // 2]  # the median
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(usual > 0, np.minimum(1.0, 0.5 * quantum / usual), 1.0)


def _at_rest(run: RunUnderCleaning, columns: list[str], values: Sequence[np.ndarray]) -> np.ndarray:
    """Return where all rates of the message are zero, or all its commands at their limits."""
    if set(columns) <= COMMANDS:
        ends = [(column == np.nanmin(column)) | (column == np.nanmax(column)) for column in values]
        return np.asarray(np.logical_and.reduce(ends))
    rates = [values[place] for place, column in enumerate(columns) if column in RATES[run.kind]]
    if not rates:
        return np.zeros(len(run.time), dtype=bool)
    sizes = [np.abs(rate) for rate in rates]
    return np.asarray(np.logical_and.reduce([size <= _STANDSTILL_SHARE * np.nanmax(size) for size in sizes]))
