"""From a log and a mapping to a recording: cut into runs, bring to common times, convert the units."""

import difflib
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.common_times import base_times, in_order, values_at
from simgap.logs.log import Log, Signal, Span
from simgap.logs.mapping import Mapping, Source
from simgap.logs.quaternions import without_jumps
from simgap.logs.table_clock import with_clock
from simgap.recordings.contract import channel_units
from simgap.recordings.recording import Recording, recording_from_frame
from simgap.recordings.units import KNOWN, conversion

_FEWEST = 2  # samples of a run


def recording_of(log: Log, mapping: Mapping) -> Recording:
    """Return the columns that a mapping names, as a recording in the contract's units.

    Each run has the times of its slowest measured column that is required, or of the mapping's `rate`. Held signals
    keep their last value, faster ones are averaged, others interpolated, never over a gap of their own.

    Args:
        log: as it was read.
        mapping: of its signals to columns.

    Raises:
        InputError: when a signal is missing, a unit does not fit, or no run has samples of all columns.
    """
    log, remarks = with_clock(log, mapping)
    sources = {name: source for name, source in mapping.columns.items() if name not in ("t", "run")}
    sliding = _is_sliding(log, sources)
    expected = channel_units(mapping.kind, sliding)
    columns = {
        column: _converted(log, source, expected[column], column) for column, source in sources.items()
    }
    columns = without_jumps(columns)
    spans = mapping.windows or log.spans or (_whole(columns, log),)
    frames = [frame for span in spans if (frame := _run(columns, span, mapping)) is not None]
    if not frames:
        raise InputError("no run has samples of all columns", log.path, "correct the mapping, or its runs")
    remarks = [*log.remarks, *remarks, *_left_out(spans, frames)]
    frame = pd.concat(frames, ignore_index=True)
    return recording_from_frame(frame, mapping.kind, sliding=sliding, warnings=remarks, where=log.path)


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
    values = signal.values.astype(float)
    if source.missing is not None:
        values = np.where(values == source.missing, np.nan, values)
    values = source.sign * source.scale * values + source.offset
    if source.times is not None:
        factor = signal_of(log, source.times)
        values = values * values_at(factor, signal.time, held=factor.held)
    unit = source.unit or signal.unit
    if unit is not None:
        values = _to_contract(values, unit, expected, f"{log.path}, column {column!r}")
    held = signal.held if source.held is None else source.held
    return in_order(replace(signal, values=values, unit=expected, held=held))


def _to_contract(values: NDArray[np.float64], unit: str, expected: str, where: str) -> NDArray[np.float64]:
    found = conversion(unit)
    if found is None:
        raise InputError(f"unknown unit {unit!r}", where, f"give one in the mapping: {', '.join(KNOWN)}")
    if found[0] != expected:
        raise InputError(f"unit {unit!r} does not fit", where, f"a unit of {expected} is needed")
    return values * found[1] + found[2]


def _whole(columns: dict[str, Signal], log: Log) -> Span:
    times = [signal.time for signal in columns.values() if len(signal.time)]
    if not times:
        raise InputError("no column has samples", log.path, "correct the mapping")
    return Span("run", float(min(time.min() for time in times)), float(max(time.max() for time in times)))


def _run(columns: dict[str, Signal], span: Span, mapping: Mapping) -> pd.DataFrame | None:
    """Return the samples of one run; None where it has too few."""
    within = {name: _within(signal, span) for name, signal in columns.items()}
    times = base_times(within, mapping.kind, mapping.rate)
    if len(times) < _FEWEST:
        return None
    if mapping.windows:  # the log goes on around them
        within = {name: _within(signal, span, beside=True) for name, signal in columns.items()}
    values = {name: values_at(signal, times, signal.held) for name, signal in within.items()}
    return pd.DataFrame({"run": span.name, "t": times - times[0], **values})


def _within(signal: Signal, span: Span, beside: bool = False) -> Signal:
    """Cut a signal to a run, with or without a sample on each side; what is held keeps the last value from before."""
    inside = (signal.time >= span.begin) & (signal.time <= span.end)
    if (signal.held or beside) and (before := np.flatnonzero(signal.time < span.begin)).size:
        inside[before[-1]] = True
    if beside and (after := np.flatnonzero(signal.time > span.end)).size:
        inside[after[0]] = True
    return replace(signal, time=signal.time[inside], values=signal.values[inside])


def _left_out(spans: tuple[Span, ...], frames: list[pd.DataFrame]) -> Iterator[str]:
    kept = {frame["run"].iloc[0] for frame in frames}
    lost = [span.name for span in spans if span.name not in kept]
    if lost:
        yield f"Left out, since a needed signal has no samples there: {', '.join(map(repr, lost))}."
