"""Tests of WPILib's SysId in a log, as runs; and the times in which the robot was enabled.

A SysId routine writes the name of its test in every cycle, and `none` at the end. Source: WPILib, `SysIdRoutineLog`.
"""

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal, Span
from simgap.logs.wpilog.entries import Entry
from simgap.logs.wpilog.records import Records

TESTS = ("quasistatic-forward", "quasistatic-reverse", "dynamic-forward", "dynamic-reverse")
_STATES = (*TESTS, "none", "")
STATE_ENTRY = "sysid-test-state-"
"""Before the name of a routine: the name of the entry of its states."""

_ENABLED = ("DS:enabled", "/DriverStation/Enabled")  # DataLogManager, AdvantageKit
_SHORTEST = 1.0  # s; a shorter time enabled is a slip of the finger


def mechanisms_of(names: Sequence[str]) -> list[str]:
    """Return the names of the SysId routines of a log, longest first: one may end with another."""
    found = {name.split(STATE_ENTRY, 1)[1] for name in names if STATE_ENTRY in name}
    return sorted(found, key=lambda name: (-len(name), name))


def test_spans(entries: Sequence[Entry], records: Records) -> tuple[Span, ...]:
    """Return the SysId tests of a log, each a run named `quasistatic-forward` and so on.

    A name that occurs again gets a number. Where several routines were logged, each name begins with its routine.
    """
    by_entry = [(entry, found) for entry in entries if (found := list(_tests(entry, records)))]
    spans = sorted(
        (begin, end, f"{_routine(entry.name)}-{test}" if len(by_entry) > 1 else test)
        for entry, found in by_entry
        for test, begin, end in found
    )
    counted: Counter[str] = Counter()
    named = []
    for begin, end, name in spans:
        counted[name] += 1
        named.append(Span(f"{name}-{counted[name]}" if counted[name] > 1 else name, begin, end))
    return tuple(named)


def enabled_spans(signals: dict[str, Signal], end: float) -> tuple[Span, ...]:
    """Return the times in which the robot was enabled, `enabled-1` and so on; empty where the log does not say."""
    signal = next((signals[name] for name in _ENABLED if name in signals), None)
    if signal is None:
        return ()
    times = np.append(signal.time, end)
    on = np.append(signal.values > 0, False)
    begins = times[:-1][np.diff(on.astype(int), prepend=0)[:-1] > 0]
    ends = times[1:][np.diff(on.astype(int)) < 0]
    kept = [(begin, stop) for begin, stop in zip(begins, ends, strict=True) if stop - begin >= _SHORTEST]
    return tuple(
        Span(f"enabled-{number}", float(begin), float(stop)) for number, (begin, stop) in enumerate(kept, 1)
    )


def _tests(entry: Entry, records: Records) -> Iterator[tuple[str, float, float]]:
    """Yield name, begin and end of each test that an entry of text names, s."""
    if entry.type != "string" or not len(entry.records):
        return
    if int(records.size[entry.records].max()) > max(map(len, _STATES)):
        return
    states = [records.content(place).decode("utf-8", "replace") for place in entry.records.tolist()]
    if not set(states) <= set(_STATES) or not set(states) & set(TESTS):
        return
    time: NDArray[np.float64] = records.time[entry.records] / 1e6
    first = 0
    for place in range(1, len(states) + 1):
        if place < len(states) and states[place] == states[first]:
            continue
        if states[first] in TESTS:
            yield states[first], float(time[first]), float(time[min(place, len(states) - 1)])
        first = place


def _routine(name: str) -> str:
    return name.split(STATE_ENTRY, 1)[1] if STATE_ENTRY in name else name.strip("/").replace("/", "-")
