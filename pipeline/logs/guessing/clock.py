"""The clock of a table: which column is the time, in which unit, and which column names the run."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simgap.logs.guessing.runs import run_of
from simgap.logs.guessing.words import words_of
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposed
from simgap.recordings.units import conversion

_TIME_WORDS = frozenset((
    "t", "time", "zeit", "timestamp", "timestamps", "stamp", "timestep", "elapsed", "clock", "seconds", "secs",
    "sec", "millis", "micros", "milliseconds", "microseconds", "nanoseconds", "msec", "usec", "nsec", "ms",
    "us", "ns", "s", "datetime", "date", "header",
))  # fmt: skip
_INDEX_WORDS = frozenset((
    "index", "idx", "i", "n", "row", "sample", "samples", "frame", "seq", "sequence", "counter", "count",
    "id", "number", "no", "nr",
))  # fmt: skip
_SLOWEST, _FASTEST = 1.0, 1e4  # Hz: below, nothing of a motor is seen; above, no robot logs
_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_EPOCH = (1e9, 3e9)  # s since 1970: from 2001 to 2065
_RISING = 0.99  # share of steps that go forward
_COARSE = 0.5  # share of rows with a new time; whole seconds that stay the same are half of a stamp


@dataclass(frozen=True)
class Clock:
    """The clock of a table.

    Attributes:
        time: the column of time; None where there is none.
        run: the column that names the run; None where there is none.
    """

    time: Proposed | None
    run: Proposed | None


def clock_of(log: Log) -> Clock:
    """Propose the columns of time and of the run of a table."""
    proposals = [found for name in log.signals if (found := _time(log.signals[name])) is not None]
    best = max(proposals, key=lambda found: found.confidence, default=None)
    return Clock(best, run_of(log, best))


def _time(signal: Signal) -> Proposed | None:
    """Propose a column as the time, if it rises."""
    values = signal.values[np.isfinite(signal.values)]
    if len(values) < 3:
        return None
    steps = np.diff(values)
    rising = float((steps > 0).mean())
    words = set(words_of(signal.name))
    named = bool(words & _TIME_WORDS) and not words & _INDEX_WORDS
    unit_of = conversion(signal.unit) if signal.unit else None
    declared = unit_of is not None and unit_of[0] == "s"
    if float((steps >= 0).mean()) < _RISING - (0.04 if named else 0.0) or not (steps > 0).any():
        return None
    if not named and not declared and (rising < _RISING or not _is_regular(steps)):
        return None
    if not named and np.ptp(steps) == 0.0 and float(steps[0]) == 1.0:
        return None  # a counter of rows
    unit, sure, why = _unit(signal, values, steps, declared)
    confidence = sure * (1.0 if named and declared else 0.97 if named or declared else 0.6)
    if _UNITS.get(unit) == 1.0 and rising < _COARSE and bool(np.all(values == np.round(values))):
        confidence, why = 0.4, "whole seconds only"
    exact = words and words <= _TIME_WORDS
    return Proposed(Source(signal.name, unit), round(min(confidence + (0.01 if exact else 0.0), 1.0), 2), why)


def _is_regular(steps: NDArray[np.float64]) -> bool:
    """Whether steps scatter little about their median, as those of a clock do and those of a motion do not."""
    median = float(np.median(steps))
    return median > 0 and float(np.median(np.abs(steps - median))) < 0.2 * median


def _unit(
    signal: Signal, values: NDArray[np.float64], steps: NDArray[np.float64], declared: bool
) -> tuple[str, float, str]:
    """Return the unit of time, how sure that is, and why."""
    step = float(np.median(steps[steps > 0]))
    if declared and signal.unit:
        found = conversion(signal.unit)
        rate = 1.0 / (step * (found[1] if found else 1.0))
        return (
            signal.unit,
            0.98 if _SLOWEST / 10 <= rate <= 10 * _FASTEST else 0.7,
            f"increases, {rate:.4g} Hz",
        )
    since = {unit: values[0] * factor for unit, factor in _UNITS.items()}
    dated = [unit for unit, time in since.items() if _EPOCH[0] < time < _EPOCH[1]]
    possible = [unit for unit, factor in _UNITS.items() if _SLOWEST <= 1.0 / (step * factor) <= _FASTEST]
    if len(dated) == 1 and dated[0] in possible:
        return dated[0], 0.98, f"counts from 1970 in {dated[0]}, {1 / (step * _UNITS[dated[0]]):.4g} Hz"
    if not possible:
        return "s", 0.3, f"increases by {step:.4g}, which is no usual step of a log in any unit"
    whole = bool(np.all(values == np.round(values)))
    if len(possible) > 1:  # whole numbers count the smaller unit, fractions belong to the greater
        unit = possible[-1] if whole else possible[0]
        other = ", ".join(possible)
        return unit, 0.75, f"increases by {step:.4g}; {other} are possible"
    unit = possible[0]
    odd = (whole and unit == "s") or (whole and step == 1.0)
    return (
        unit,
        0.6 if odd else 0.96,
        f"increases by {step:.4g}, so in {unit} at {1 / (step * _UNITS[unit]):.4g} Hz",
    )
