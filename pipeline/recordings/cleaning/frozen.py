"""Samples that were repeated because no newer message arrived, although the machine moved."""

import numpy as np
from scipy.spatial.transform import Rotation

from simgap.recordings.cleaning.channels import ATTITUDE, COMMANDS, RATES, SPECIFIC_FORCE, telegrams
from simgap.recordings.cleaning.work import RunUnderCleaning, stretches_of

_COINCIDENCE_LEVEL = 0.01  # a repetition likelier than this may be a coincidence
_CHANGES_AROUND = 11  # changes over which the usual step is taken
_LOW_RATE = 0.5  # share of repetitions above which the channel is simply logged less often
_STANDSTILL_SHARE = 1e-3  # of a channel's largest value: below, it stands still
_EQUAL_SHARE = 1e-9


def erase_frozen(run: RunUnderCleaning, max_gap: float) -> None:
    """Erase repetitions of a whole message that cannot be chance.

    A quantised channel repeats by chance when it moves by less than its quantum q per sample; with the usual
    step s around the repetition the chance is about q / 2s per channel, and the product over the channels of
    a message. Standstill (all rates zero), commands at their limits or constant for over `max_gap` s, and
    channels logged at a lower rate are left.
    """
    for columns in telegrams(run.kind, run.columns):
        values = run.channel(*columns)
        known = np.isfinite(values).all(axis=1)
        if known.sum() < 3 * _CHANGES_AROUND:
            continue
        repeated = _repeated(values, run.stretch)
        if columns == SPECIFIC_FORCE and run.has(ATTITUDE):
            repeated |= _repeated_in_world(values, run.channel(*ATTITUDE), run.stretch)
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


def _repeated(values: np.ndarray, stretch: np.ndarray) -> np.ndarray:
    same = (values[1:] == values[:-1]).all(axis=1) & (stretch[1:] == stretch[:-1])
    return np.concatenate([[False], same])


def _repeated_in_world(force: np.ndarray, attitude: np.ndarray, stretch: np.ndarray) -> np.ndarray:
    """Find held accelerations of loggers that turn them into world axes: held there, they move in body
    axes."""
    result = np.zeros(len(force), dtype=bool)
    known = np.flatnonzero(np.isfinite(force).all(axis=1) & np.isfinite(attitude).all(axis=1))
    if len(known) > 1:
        world = Rotation.from_quat(attitude[known], scalar_first=True).apply(force[known])
        close = np.abs(np.diff(world, axis=0)).max(axis=1) <= _EQUAL_SHARE * np.abs(world[1:]).max(axis=1)
        neighbours = (np.diff(known) == 1) & (stretch[known[1:]] == stretch[known[:-1]])
        result[known[1:][close & neighbours]] = True
    return result


def _unlikely(values: np.ndarray, repeated: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Return which repetitions are too unlikely, of those in motion, shape (samples,)."""
    result = np.zeros(len(values), dtype=bool)
    judged = np.flatnonzero(repeated & moving)
    fresh = np.flatnonzero(~repeated)
    if len(fresh) < 2 or not len(judged):
        return result
    step = np.abs(np.diff(values[fresh], axis=0))
    step[np.isnan(step)] = 0.0
    before = np.searchsorted(fresh, judged, side="right") - 1  # the sample that is repeated
    last = len(step) - 1
    beside, place = np.unique(np.clip([before - 1, before], 0, last), return_inverse=True)
    chance = _chances(step, beside)[place].max(axis=0)  # of the likelier of the two steps beside
    result[judged] = chance < _COINCIDENCE_LEVEL
    return result


def _chances(step: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the chance that the next sample is the same, at some of the steps from one fresh sample to the next."""
    quantum = np.min(step, axis=0, where=step > 0, initial=np.inf)
    around = np.arange(_CHANGES_AROUND) - _CHANGES_AROUND // 2
    chance = np.ones(len(places))
    for column, smallest in zip(step.T, quantum, strict=True):
        windows = column[np.clip(places[:, None] + around, 0, len(column) - 1)]
        usual = np.median(windows, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            chance *= np.where(usual > 0, np.minimum(1.0, 0.5 * smallest / usual), 1.0)
    return chance


def _at_rest(run: RunUnderCleaning, columns: list[str], values: np.ndarray) -> np.ndarray:
    """Return where all rates of the message are zero, or all its commands at their limits."""
    if set(columns) <= COMMANDS:
        low, high = np.nanmin(values, axis=0), np.nanmax(values, axis=0)
        return ((values == low) | (values == high)).all(axis=1)
    rates = [place for place, column in enumerate(columns) if column in RATES[run.kind]]
    if not rates:
        return np.zeros(len(values), dtype=bool)
    size = np.abs(values[:, rates])
    return (size <= _STANDSTILL_SHARE * np.nanmax(size, axis=0)).all(axis=1)
