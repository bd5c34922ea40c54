"""From a log and a mapping to a recording: cut into runs, bring to common times, convert the units."""

import difflib
from collections.abc import Iterator
from collections.abc import Mapping as AbstractMapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.common_times import base_times, commanded_at, in_order, values_at
from simgap.logs.log import Log, Signal, Span
from simgap.logs.mapping import Mapping, Source
from simgap.logs.quaternions import without_jumps
from simgap.logs.ratio import with_ratios
from simgap.logs.table_clock import with_clock
from simgap.recordings.cleaning.channels import ANGLES
from simgap.recordings.contract import channel_units
from simgap.recordings.recording import Recording, recording_from_frame
from simgap.recordings.units import conversion, factor_and_offset

_FEWEST = 2  # samples of a run


@dataclass(frozen=True)
class Converted:
    """The columns of a log in the contract's units, each at its own times; the log is no longer needed.

    Attributes:
        columns: by name.
        mapping: that named them.
        rate: of the recording, samples per second; None for that of a column.
        spans: of the runs.
        sliding: whether a joint's position is in metres.
        path: of the log, to name in an error.
        remarks: what was damaged, left out or made.
    """

    columns: dict[str, Signal]
    mapping: Mapping
    rate: float | None
    spans: tuple[Span, ...]
    sliding: bool
    path: str
    remarks: tuple[str, ...]


def recording_of(log: Log, mapping: Mapping, platform: AbstractMapping[str, Any] | None = None) -> Recording:
    """Return the columns that a mapping names, as a recording in the contract's units.

    Args:
        log: as it was read.
        mapping: of its signals to columns.
        platform: its keys, for a mapping with ratios.

    Raises:
        InputError: when a signal is missing, a unit does not fit, or no run has samples of all columns.
    """
    return at_common_times(converted(log, mapping, platform))


def converted(log: Log, mapping: Mapping, platform: AbstractMapping[str, Any] | None = None) -> Converted:
    """Return the columns that a mapping names; the arguments are those of `recording_of`.

    Raises:
        InputError: when a signal is missing, or a unit does not fit.
    """
    mapping = with_ratios(mapping, platform)
    rate = None if log.tabular and "t" not in mapping.columns else mapping.rate
    log, remarks = with_clock(log, mapping)
    sources = {name: source for name, source in mapping.columns.items() if name not in ("t", "run")}
    sliding = _is_sliding(log, sources)
    expected = channel_units(mapping.kind, sliding)
    columns = without_jumps(
        {column: _converted(log, source, expected[column], column) for column, source in sources.items()}
    )
    spans = mapping.windows or log.spans or (_whole(columns, log),)
    return Converted(columns, mapping, rate, spans, sliding, log.path, (*log.remarks, *remarks))


def at_common_times(found: Converted) -> Recording:
    """Return columns as a recording.

    Each run has the times of its slowest measured column that is required, or of the mapping's `rate`. Held signals
    keep their last value, faster ones are averaged, others interpolated, never over a gap of their own.

    Args:
        found: of a log; the columns are taken out of it, so that none is held twice.

    Raises:
        InputError: when no run has samples of all columns.
    """
    columns, mapping, spans = found.columns, found.mapping, found.spans
    parts = [(span.name, _run(dict(columns), span, mapping, found.rate)) for span in spans[:-1]]
    parts.append((spans[-1].name, _run(columns, spans[-1], mapping, found.rate)))
    runs = [(name, run) for name, run in parts if run is not None]
    if not runs:
        raise InputError("no run has samples of all columns", found.path, "correct the mapping, or its runs")
    left_out = _left_out(spans, {name for name, _ in runs})
    remarks = [*found.remarks, *left_out, *_integrated(mapping.columns)]
    return recording_from_frame(
        _frame(runs), mapping.kind, sliding=found.sliding, warnings=remarks, where=found.path
    )


def signal_of(log: Log, name: str) -> Signal:
    """Return a signal of a log by its name.

    Raises:
        InputError: when there is none, with the nearest name that there is.
    """
    if name in log.signals:
        return log.signals[name]
    near = difflib.get_close_matches(name, list(log.signals), n=1)
    remedy = f"did you mean {near[0]!r}?" if near else "simgap inspect lists its signals"
    raise InputError(f"there is no signal {name!r}", log.path, remedy)


def _is_sliding(log: Log, sources: dict[str, Source]) -> bool:
    chosen = (sources[name] for name in ("position", "velocity", "position_command") if name in sources)
    found = (conversion(source.unit or signal_of(log, source.signal).unit or "") for source in chosen)
    return any(entry is not None and entry[0] in ("m", "m/s") for entry in found)


def _converted(log: Log, source: Source, expected: str, column: str) -> Signal:
    """Return the signal of a column in the contract's unit."""
    signal = signal_of(log, source.signal)
    values = signal.values.astype(float)  # a copy, which is changed in its place
    if source.missing is not None:
        values[values == source.missing] = np.nan
    values *= source.sign * source.scale
    values += source.offset
    if source.times is not None:
        other = signal_of(log, source.times)
        values *= values_at(other, signal.time, held=other.held)
    unit = source.unit or signal.unit
    if unit is not None:
        needed = f"{expected}/s" if source.integrate else expected
        factor, added = _conversion(source, unit, needed, f"{log.path}, column {column!r}")
        values *= factor
        values += added
    if source.root:
        values = np.sqrt(np.maximum(values, 0.0))
    if source.integrate:
        values = _integral(signal.time, values)
    if column in ANGLES:
        known = np.isfinite(values)
        values[known] = np.unwrap(values[known])  # between π and −π lies no angle to interpolate
    held = signal.held if source.held is None else source.held
    return in_order(replace(signal, values=values, unit=expected, held=held))


def _conversion(source: Source, unit: str, needed: str, where: str) -> tuple[float, float]:
    """Return factor and offset of a unit; of one that only the log says, an error tells how to overrule it."""
    found = conversion(unit)
    if source.unit is None and (found is None or found[0] != needed):
        remedy = f"say unit: in its line of the mapping, for the value with its scale: one of {needed}"
        raise InputError(f"{source.signal!r} is in {unit!r}, which is no unit of {needed}", where, remedy)
    return factor_and_offset(unit, needed, where)


def _integral(time: NDArray[np.float64], rate: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the integral by trapezoids, NaN where the rate is unknown."""
    known = np.isfinite(rate)
    steps = 0.5 * (rate[known][1:] + rate[known][:-1]) * np.diff(time[known])
    values = np.full(len(rate), np.nan)
    values[known] = np.concatenate([[0.0], np.cumsum(steps)])[: known.sum()]
    return values


def _whole(columns: dict[str, Signal], log: Log) -> Span:
    times = [signal.time for signal in columns.values() if len(signal.time)]
    if not times:
        raise InputError("no column has samples", log.path, "correct the mapping")
    return Span("run", float(min(time.min() for time in times)), float(max(time.max() for time in times)))


def _run(
    columns: dict[str, Signal], span: Span, mapping: Mapping, rate: float | None
) -> dict[str, NDArray[np.float64]] | None:
    """Return the times and the columns of one run, each (n,); None where it has too few.

    Each column is taken out of `columns` when it is at those times, so that none is held twice.
    """
    times = base_times({name: _within(signal, span) for name, signal in columns.items()}, mapping.kind, rate)
    times = times[np.searchsorted(times, span.begin) :]  # a held value may be from before
    if len(times) < _FEWEST:
        return None
    values = {}
    for name in list(columns):
        beside = bool(mapping.windows)  # the log goes on around them
        signal = _within(columns.pop(name), span, beside=beside)
        values[name] = commanded_at(signal, times) if signal.held else values_at(signal, times, held=False)
    for name, source in mapping.columns.items():
        if source.integrate and np.isfinite(values[name]).any():
            values[name] = values[name] - values[name][np.isfinite(values[name])][0]
    return {"t": times - times[0], **values}


def _frame(runs: list[tuple[str, dict[str, NDArray[np.float64]]]]) -> pd.DataFrame:
    """Return the runs one below the other; each column is taken out of them, so that it is not held twice."""
    lengths = [len(run["t"]) for _, run in runs]
    columns: dict[str, Any] = {"run": pd.array([name for name, _ in runs], dtype="str").repeat(lengths)}
    for name in list(runs[0][1]):
        parts = [run.pop(name) for _, run in runs]
        columns[name] = parts[0] if len(parts) == 1 else np.concatenate(parts)
    return pd.DataFrame(columns, copy=False)


def _within(signal: Signal, span: Span, beside: bool = False) -> Signal:
    """Cut a signal to a run, with or without a sample on each side; what is held keeps the last value from before."""
    first = np.searchsorted(signal.time, span.begin)
    past = np.searchsorted(signal.time, span.end, side="right")
    if signal.held or beside:
        first -= first > 0
    if beside:
        past += 1
    return replace(signal, time=signal.time[first:past], values=signal.values[first:past])


def _integrated(sources: AbstractMapping[str, Source]) -> Iterator[str]:
    for column, source in sources.items():
        if source.integrate:
            yield f"Column {column!r} was integrated from {source.signal!r}, from zero in each run."


def _left_out(spans: tuple[Span, ...], kept: set[str]) -> Iterator[str]:
    lost = [span.name for span in spans if span.name not in kept]
    if lost:
        yield f"Left out, since a needed signal has no samples there: {', '.join(map(repr, lost))}."
