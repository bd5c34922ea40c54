"""The clock and the runs of a table, which only the mapping knows: column `t`, and column `run`."""

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.log import Log, Signal, Span
from simgap.logs.mapping import Mapping
from simgap.recordings.units import conversion

_TIME_REMEDY = (
    "add t: {from: COLUMN, unit: s} to the mapping, or rate: HERTZ where all samples are as far apart"
)
_MOST_RESETS = 0.1  # of the rows; a column that goes back more often is no clock
_PAUSE = 1.0  # s put between two runs on the common clock; any time above zero does


def with_clock(log: Log, mapping: Mapping) -> tuple[Log, list[str]]:
    """Return a log whose signals have times in seconds, and remarks on what was done for that.

    A table gets the times of its column `t`. Its runs are those of its column `run`; where the clock goes back inside
    of one, another run begins. Each run is moved behind the one before, so that all share one clock.

    Raises:
        InputError: when a table's column of time is not named or has no unit that is a time.
    """
    if not log.tabular:
        return log, []
    seconds = _seconds(log, mapping)
    codes, names = _runs(log, mapping, len(seconds))
    parts, resets = _parts(seconds, codes, names, log.path)
    clock, spans = np.full(len(seconds), np.nan), []
    begin = 0.0
    for name, rows in parts:
        times = seconds[rows] - seconds[rows[0]]
        clock[rows] = begin + times
        spans.append(Span(name, begin, float(begin + times[-1])))
        begin += float(times[-1]) + _PAUSE
    order = np.concatenate([rows for _, rows in parts])
    ordered = clock[order]
    signals = {name: _on_clock(signal, clock, order, ordered) for name, signal in log.signals.items()}
    remarks = [
        f"The clock was reset inside of run {name!r}: it starts anew, so it was split there."
        for name in resets
    ]
    return replace(log, signals=signals, spans=tuple(spans), tabular=False), remarks


def _seconds(log: Log, mapping: Mapping) -> NDArray[np.float64]:
    source = mapping.columns.get("t")
    if source is None and mapping.rate is not None:
        return np.arange(_rows(log)) / mapping.rate
    if source is None or source.signal not in log.signals:
        what = "no column of time is named" if source is None else f"there is no column {source.signal!r}"
        raise InputError(what, log.path, _TIME_REMEDY)
    signal = log.signals[source.signal]
    unit = source.unit or signal.unit or "s"
    found = conversion(unit)
    if found is None or found[0] != "s":
        raise InputError(f"{unit!r} is no unit of time", f"{log.path}, column 't'", "give s, ms, us or ns")
    seconds = np.full(_rows(log), np.nan)
    seconds[signal.time.astype(int)] = signal.values * found[1] * source.scale
    return seconds


def _rows(log: Log) -> int:
    last = [int(signal.time[-1]) + 1 for signal in log.signals.values() if len(signal.time)]
    return max([*last, *(len(text) for text in log.texts.values())], default=0)


def _runs(log: Log, mapping: Mapping, rows: int) -> tuple[NDArray[np.int64], list[str]]:
    """Return the number of each row's run, −1 where it has none, and the names of the runs."""
    source = mapping.columns.get("run")
    if source is None:
        return np.zeros(rows, dtype=np.int64), ["run"]
    if source.signal in log.texts:
        codes, unique = pd.factorize(log.texts[source.signal])
        return codes, [str(value) for value in unique]
    if source.signal in log.signals:
        numbers = np.full(rows, np.nan)
        signal = log.signals[source.signal]
        numbers[signal.time.astype(int)] = signal.values
        codes, unique = pd.factorize(pd.Series(numbers).ffill().bfill().to_numpy())
        return codes, [f"{number:g}" for number in unique]
    raise InputError(f"there is no column {source.signal!r}", log.path, "correct run in the mapping")


def _parts(
    seconds: NDArray[np.float64], codes: NDArray[np.int64], names: list[str], where: str
) -> tuple[list[tuple[str, NDArray[np.int64]]], list[str]]:
    """Return the rows of each run with a known time, and the runs in which the clock goes back."""
    usable = np.flatnonzero(np.isfinite(seconds) & (codes >= 0))
    if not len(usable):
        raise InputError("no row has a time", f"{where}, column 't'", "correct the mapping")
    rows = usable[np.argsort(codes[usable], kind="stable")]
    other = np.diff(codes[rows]) != 0
    back = ~other & (np.diff(seconds[rows]) < 0)
    if back.sum() > max(1.0, _MOST_RESETS * len(rows)):
        raise InputError(f"goes back in {back.sum()} rows", f"{where}, column 't'", "name another column")
    parts: list[tuple[str, NDArray[np.int64]]] = []
    resets = {names[code] for code in codes[rows[1:][back]]}
    numbers = dict.fromkeys(resets, 0)
    for piece in np.split(rows, np.flatnonzero(other | back) + 1):
        name = names[codes[piece[0]]]
        if name in numbers:
            numbers[name] += 1
            name = f"{name}-{numbers[name]}"
        parts.append((name, piece))
    return parts, [name for name in names if name in resets]


def _on_clock(
    signal: Signal, clock: NDArray[np.float64], order: NDArray[np.int64], ordered: NDArray[np.float64]
) -> Signal:
    """Return a signal of a table with its times on the common clock, in the order of the runs."""
    if len(signal.time) == len(clock):
        return replace(signal, time=ordered, values=signal.values[order])
    place = signal.time.astype(np.int64)
    rank = np.full(len(clock), -1)
    rank[order] = np.arange(len(order))
    place_in_order = rank[place]
    kept = np.flatnonzero(place_in_order >= 0)
    kept = kept[np.argsort(place_in_order[kept])]
    return replace(signal, time=clock[place[kept]], values=signal.values[kept])
