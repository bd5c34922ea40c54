"""Columns that stand still although what they are the rate or the position of moves, and batteries of no voltage."""

import numpy as np

from simgap.recordings.cleaning.halved import SPEEDS
from simgap.recordings.cleaning.work import RunUnderCleaning, stretches_of
from simgap.recordings.cleaning.wraps import PAIRS

_SHORTEST = 0.1  # s: a filter lags less
_FEWEST = 5  # samples
_FAST = 0.3  # of the usual fast speed: slower, a position may repeat, and a speed may be below its threshold
_CHANGING = 0.5  # share of its samples in which a speed has to change to tell that the machine moves
_USUAL = 3.0  # times what a rate and its position are usually apart at most
_CHANCE = 1e-6  # of so many repeats in a row, in a recording
_MOST = 0.5  # share of a run; a column that is dead for longer is none
_EMPTY = 0.3  # of the usual voltage: no battery falls to it and comes back


def erase_dead(run: RunUnderCleaning) -> None:
    """Erase a rate or position that repeats one number while the other one moves, and a battery's drop-outs."""
    for rate, position in PAIRS.get(run.kind, []):
        if not run.has([rate, position]):
            continue
        values, place = run.column(rate), run.column(position)
        still = [_held(run, values), _held(run, place)]
        if run.kind == "quadrotor":  # where both repeat, a whole message did not arrive, which is seen later
            both = [each for each in still[0] if each in still[1]]
            still = [[each for each in stretches if each not in both] for stretches in still]
        if not any(still):
            continue
        values = values.copy()  # which the first of two erasures leaves as they are
        with np.errstate(invalid="ignore", divide="ignore"):
            moved = np.gradient(place, run.time) if len(place) > 1 else np.zeros(len(place))
        _erase(run, rate, still[0], moved, values - moved)
        _erase(run, position, still[1], values, values - moved)
    _erase_alone(run)
    _erase_empty_battery(run)


def _erase_alone(run: RunUnderCleaning) -> None:
    """Erase where one of four counted speeds repeats one value, not zero, while the other three change."""
    speeds = [column for column in SPEEDS.get(run.kind, []) if column in run.columns]
    values = {column: run.column(column) for column in speeds}
    alone = {}
    for column in speeds:
        rows = np.zeros(len(run.time), dtype=bool)
        for first, past in _held(run, values[column]):
            others = [values[other][first - 1 : past] for other in speeds if other != column]
            changing = all(np.mean(np.diff(other) != 0) > _CHANGING for other in others)
            if others and changing and values[column][first] != 0:
                rows[first - 1 : past] = True
        alone[column] = rows
    for column, rows in alone.items():
        _leave_out(run, column, rows)


def _held(run: RunUnderCleaning, values: np.ndarray) -> list[tuple[int, int]]:
    """Return where a column repeats its last value for long, [first, one past last]."""
    repeats = np.zeros(len(values), dtype=bool)
    repeats[1:] = values[1:] == values[:-1]
    return [
        (first, past)
        for first, past in stretches_of(repeats).tolist()
        if past - first >= _FEWEST and run.time[past - 1] - run.time[first] >= _SHORTEST
    ]


def _erase(
    run: RunUnderCleaning,
    column: str,
    held: list[tuple[int, int]],
    speed: np.ndarray,
    apart: np.ndarray,
) -> None:
    """Erase where a column repeats its last value and is far from what the other one tells.

    A steady speed repeats one value, too, but then both agree. To and fro would cancel over the whole stretch, so
    that it is looked at in parts. A column whose noise never lets it repeat need not be far from the other one where
    the machine is fast: farther than usual is enough.
    """
    known = np.abs(speed[np.isfinite(speed)])
    if not held or len(known) < 2 * _FEWEST:
        return
    far = _FAST * float(np.quantile(known, 0.95))
    part = max(_FEWEST, round(_SHORTEST / run.time_step))
    outside = _outside(held, len(speed))
    repeating = _share_of_repeats(run.column(column)[outside])
    unusual = _USUAL * _usual_mean(apart[outside], part)
    rows = np.zeros(len(speed), dtype=bool)
    for first, past in held:
        mean = _largest_mean(apart[first:past], part)
        moves = abs(float(speed[first:past].mean())) > far
        noisy = len(speed) * repeating ** (past - first) < _CHANCE
        if mean > far or (noisy and moves and mean > unusual):
            rows[first - 1 : past] = True
    _leave_out(run, column, rows)


def _leave_out(run: RunUnderCleaning, column: str, rows: np.ndarray) -> None:
    if 0 < rows.sum() < _MOST * len(rows):
        run.erase(rows, [column], "dead", "repeats one value although the machine moves")
        run.remarks.append(
            f"Channel {column!r} repeats one value in {int(rows.sum())} samples of run {run.name!r} although the "
            "machine moves; these were left out."
        )


def _outside(held: list[tuple[int, int]], length: int) -> np.ndarray:
    """Return which of so many rows are in none of the stretches."""
    outside = np.ones(length, dtype=bool)
    for first, past in held:
        outside[first - 1 : past] = False
    return outside


def _share_of_repeats(values: np.ndarray) -> float:
    """Return in which share of its rows a column repeats its last value, with one repeat more than was seen."""
    return float((np.sum(values[1:] == values[:-1]) + 1) / max(len(values), 1))


def _usual_mean(values: np.ndarray, count: int) -> float:
    """Return the size that 95 % of the means of so many values in a row do not exceed; infinite if there is none."""
    known = values[np.isfinite(values)]
    if len(known) < count:
        return np.inf
    means = np.convolve(known, np.full(count, 1.0 / count), mode="valid")
    return float(np.quantile(np.abs(means), 0.95))


def _largest_mean(values: np.ndarray, count: int) -> float:
    """Return the size of the largest mean of so many values in a row, or of all if there are fewer."""
    count = min(count, len(values))
    return float(np.abs(np.convolve(values, np.full(count, 1.0 / count), mode="valid")).max())


def _erase_empty_battery(run: RunUnderCleaning) -> None:
    if "battery_voltage" not in run.columns:
        return
    volts = run.column("battery_voltage")
    known = volts[np.isfinite(volts)]
    if not len(known):
        return
    rows = volts < _EMPTY * float(np.median(known))
    if rows.any():
        least = float(volts[rows].min())
        run.erase(rows, ["battery_voltage"], "dead", "no voltage of a battery")
        run.remarks.append(
            f"Channel 'battery_voltage' falls to {least:.3g} V in {int(rows.sum())} samples of run "
            f"{run.name!r}, which no battery does; these were left out."
        )
