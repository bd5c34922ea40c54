"""WPILib DataLogs: `.wpilog`, as DataLogManager, AdvantageKit and converters of other logs write them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from simgap.errors import InputError
from simgap.logs.log import Log, Signal
from simgap.logs.wpilog.entries import Entry, entries_of
from simgap.logs.wpilog.motors import JOINED, joined, sysid_motors
from simgap.logs.wpilog.records import Records, read_records
from simgap.logs.wpilog.signals import cycle_of, decode, has_pause
from simgap.logs.wpilog.spans import STATE_ENTRY, enabled_spans, test_spans

FORMAT = "WPILOG"
_SCHEMA = ".schema/struct:"
_FACTS = (
    "Metadata/",
    "FMSInfo/EventName",
    STATE_ENTRY,
)  # AdvantageKit; NetworkTables of a match; SysId routines
_LONGEST_FACT = 80  # characters: more is no fact to read at a glance
_MOST_REMARKS = 8  # of one sort of damage; the rest is counted


def read(path: Path) -> Log:
    """Read a DataLog: booleans, numbers, arrays and structs as signals, texts as facts and as names of runs.

    Runs are the tests of SysId where it was logged, else the times in which the robot was enabled.

    Raises:
        InputError: when it is no DataLog, or holds no signal.
    """
    records = read_records(path)
    entries, remarks = entries_of(records)
    signals, problems = _signals(entries, records)
    if not signals:
        raise InputError("holds no signal", str(path), "log numbers of the robot: see docs/how_to/frc.md")
    end = max(float(signal.time[-1]) for signal in signals.values())
    tests = test_spans(entries, records)
    motors = sysid_motors(list(signals), [entry.name for entry in entries])
    together = joined(motors, signals, tests)
    if together:
        remarks.append(f"{len(motors)} motors of SysId: signals {JOINED}* hold them one behind the other.")
    return Log(
        FORMAT,
        str(path),
        signals | together,
        tests or enabled_spans(signals, end),
        _facts(entries, records),
        (*records.remarks, *_few(remarks), *_few(problems)),
    )


def _signals(entries: Sequence[Entry], records: Records) -> tuple[dict[str, Signal], list[str]]:
    """Return the signals with times, and what was left out."""
    schemas = _schemas(entries, records)
    signals: dict[str, Signal] = {}
    on_change: list[str] = []
    remarks: list[str] = []
    for entry in entries:
        if not len(entry.records):
            continue
        found = decode(entry, records, schemas)
        remarks += found.remarks
        for signal in found.signals:
            name = f"{signal.name} ({entry.type})" if signal.name in signals else signal.name
            signals[name] = replace(signal, name=name)
            on_change += [name] if found.on_change else []
    signals = {name: signal for name, signal in signals.items() if len(signal.time)}
    cycle = cycle_of(signals)
    end = max((float(signal.time[-1]) for signal in signals.values()), default=0.0)
    for name in on_change:
        if name in signals and has_pause(signals[name], cycle, end):
            signals[name] = replace(signals[name], held=True)
    return signals, remarks


def _schemas(entries: Sequence[Entry], records: Records) -> Mapping[str, str]:
    """Return the text of each struct's schema."""
    return {
        entry.name.rsplit(_SCHEMA, 1)[1]: records.content(int(entry.records[-1])).decode("utf-8", "replace")
        for entry in entries
        if _SCHEMA in entry.name and len(entry.records)
    }


def _facts(entries: Sequence[Entry], records: Records) -> dict[str, str]:
    """Return what the log says in words: the robot, its program and the match."""
    return {
        entry.name: text
        for entry in entries
        if any(word in entry.name for word in _FACTS) and entry.type == "string" and len(entry.records)
        if 0 < records.size[entry.records[-1]] <= _LONGEST_FACT
        if (text := records.content(int(entry.records[-1])).decode("utf-8", "replace").strip())
    }


def _few(remarks: Sequence[str]) -> Sequence[str]:
    if len(remarks) <= _MOST_REMARKS:
        return remarks
    return [*remarks[:_MOST_REMARKS], f"There are {len(remarks) - _MOST_REMARKS} more remarks of this sort."]
