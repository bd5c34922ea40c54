"""The clock and the runs of a table, which only the mapping knows: column `t`, and column `run`."""

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.log import Log, Signal, Span
from simgap.logs.mapping import Mapping
from simgap.recordings.units import conversion

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
    names = _run_names(log, mapping, len(seconds))
    parts, resets = _parts(seconds, names)
    clock, spans = np.full(len(seconds), np.nan), []
    begin = 0.0
    for name, rows in parts:
        times = seconds[rows] - seconds[rows[0]]
        clock[rows] = begin + times
        spans.append(Span(name, begin, float(begin + times[-1])))
        begin += float(times[-1]) + _PAUSE
    order = np.concatenate([rows for _, rows in parts])
    signals = {name: _on_clock(signal, clock, order) for name, signal in log.signals.items()}
    remarks = [
        f"The clock was reset inside of run {name!r}: it starts anew, so it was split there."
        for name in resets
    ]
    return replace(log, signals=signals, spans=tuple(spans), tabular=False), remarks


def _seconds(log: Log, mapping: Mapping) -> NDArray[np.float64]:
    source = mapping.columns.get("t")
    if source is None or source.signal not in log.signals:
        what = "no column of time is named" if source is None else f"there is no column {source.signal!r}"
        raise InputError(what, log.path, "add it to the mapping, as t: {from: COLUMN, unit: s}")
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


def _run_names(log: Log, mapping: Mapping, rows: int) -> list[str]:
    source = mapping.columns.get("run")
    if source is None:
        return ["run"] * rows
    if source.signal in log.texts:
        return [str(value) for value in log.texts[source.signal]]
    if source.signal in log.signals:
        numbers = np.full(rows, np.nan)
        signal = log.signals[source.signal]
        numbers[signal.time.astype(int)] = signal.values
        return [f"{number:g}" for number in pd.Series(numbers).ffill().bfill()]
    raise InputError(f"there is no column {source.signal!r}", log.path, "correct run in the mapping")


def _parts(
    seconds: NDArray[np.float64], names: list[str]
) -> tuple[list[tuple[str, NDArray[np.int64]]], list[str]]:
    """Return the rows of each run with a known time, and the runs in which the clock goes back."""
    parts, resets = [], []
    codes, unique = pd.factorize(np.array(names, dtype=object))
    for code, name in enumerate(unique):
        rows = np.flatnonzero((codes == code) & np.isfinite(seconds))
        if not len(rows):
            continue
        back = np.flatnonzero(np.diff(seconds[rows]) < 0) + 1
        pieces = np.split(rows, back)
        resets += [str(name)] if len(pieces) > 1 else []
        parts += [
            (f"{name}-{number}" if len(pieces) > 1 else str(name), piece)
            for number, piece in enumerate(pieces, 1)
        ]
    if not parts:
        raise InputError("no row has a time", "column 't'", "correct the mapping")
    return parts, resets


def _on_clock(signal: Signal, clock: NDArray[np.float64], order: NDArray[np.int64]) -> Signal:
    """Return a signal of a table with its times on the common clock, in the order of the runs."""
    values = np.full(len(clock), np.nan)
    values[signal.time.astype(int)] = signal.values
    present = np.zeros(len(clock), dtype=bool)
    present[signal.time.astype(int)] = True
    kept = order[present[order]]
    return replace(signal, time=clock[kept], values=values[kept])
