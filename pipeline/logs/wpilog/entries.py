"""Entries of a WPILib DataLog: name, type and metadata, and the records of each."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.logs.wpilog.records import Records

_START, _FINISH, _METADATA = 0, 1, 2
_LONGEST = (
    86_400.0e6  # µs around the median time: a robot logs from when it is switched on until it is switched off
)
_SOME = 10_000  # records whose median time is taken for that of all


@dataclass(frozen=True)
class Entry:
    """What is written under one name.

    Attributes:
        name: as the file has it.
        type: `double`, `struct:Pose2d[]`, …
        metadata: any text, JSON as a rule.
        records: places in `Records`, in the order of time, (n,).
    """

    name: str
    type: str
    metadata: str
    records: NDArray[Any]


def entries_of(records: Records) -> tuple[list[Entry], list[str]]:
    """Return the entries of a file by their first start, and remarks on records that were left out or moved.

    An entry that is started anew under the same name and type is one entry.
    """
    remarks: list[str] = []
    usable = _with_times(records, remarks)
    order = _by_entry(records.entry, usable)
    numbers = records.entry[order]
    found: dict[tuple[str, str], list[Entry]] = {}
    taken = 0
    for number, begin, end, entry in _started(records):
        low, high = np.searchsorted(numbers, [number, number + 1])
        own = order[low:high]
        own = own[slice(*np.searchsorted(own, [begin, end]))]
        taken += len(own)
        found.setdefault((entry.name, entry.type), []).append(replace(entry, records=own))
    unknown = int(np.count_nonzero(numbers)) - taken
    if unknown > 0:
        remarks.append(
            f"{unknown} records belong to no entry that the file names: they were left out. The file may be damaged."
        )
    joined = [_joined(parts) for parts in found.values()]
    return [_in_time(entry, records, remarks) for entry in joined], remarks


def _with_times(records: Records, remarks: list[str]) -> NDArray[np.bool_]:
    """Return which records have a time that can be; NetworkTables keeps some values from before the robot's clock."""
    some = records.time[:: max(len(records.time) // _SOME, 1)]
    median = float(np.median(some)) if len(some) else 0.0
    first, last = max(median - _LONGEST, 0.0), median + _LONGEST
    usable = (records.time >= first) & (records.time < last)
    usable |= records.entry == 0
    lost = len(usable) - int(np.count_nonzero(usable))
    if lost:
        remarks.append(f"{lost} records have an invalid time: they were left out.")
    return usable


def _by_entry(entry: NDArray[np.unsignedinteger[Any]], usable: NDArray[np.bool_]) -> NDArray[Any]:
    """Return the usable records by their entry, each entry's in the order of the file."""
    short = (
        entry.astype(np.uint16) if entry.itemsize > 2 and len(entry) and int(entry.max()) < 1 << 16 else entry
    )  # sorted much faster
    order = np.argsort(short, kind="stable").astype(np.uint32 if len(entry) < 1 << 32 else np.int64)
    return order if usable.all() else order[usable[order]]


def _started(records: Records) -> Iterator[tuple[int, int, int, Entry]]:
    """Yield number, first and last record of each entry, as control records start and finish it."""
    open_entries: dict[int, tuple[int, Entry]] = {}
    for place in np.flatnonzero(records.entry == 0).tolist():
        content = records.content(place)
        number = int.from_bytes(content[1:5], "little")
        if len(content) < 5 or content[0] not in (_START, _FINISH, _METADATA):
            continue
        if content[0] == _METADATA:
            if number in open_entries and (texts := _texts(content, 5, 1)) is not None:
                begin, entry = open_entries[number]
                open_entries[number] = (begin, replace(entry, metadata=texts[0]))
            continue
        if number in open_entries:
            begin, entry = open_entries.pop(number)
            yield number, begin, place, entry
        if content[0] == _START and (texts := _texts(content, 5, 3)) is not None:
            open_entries[number] = (place, Entry(texts[0], texts[1], texts[2], np.empty(0, np.int64)))
    for number, (begin, entry) in open_entries.items():
        yield number, begin, len(records.entry), entry


def _texts(content: bytes, place: int, count: int) -> list[str] | None:
    """Return texts that follow each other, each with its length before; None where the content is too short."""
    texts = []
    for _ in range(count):
        length = int.from_bytes(content[place : place + 4], "little")
        if place + 4 + length > len(content):
            return None
        texts.append(content[place + 4 : place + 4 + length].decode("utf-8", "replace"))
        place += 4 + length
    return texts


def _joined(parts: list[Entry]) -> Entry:
    if len(parts) == 1:
        return parts[0]
    return replace(parts[0], records=np.sort(np.concatenate([part.records for part in parts])))


def _in_time(entry: Entry, records: Records, remarks: list[str]) -> Entry:
    """Return an entry with increasing times; of several records at one time, the last one counts."""
    time = records.time[entry.records]
    steps = np.diff(time)
    if (steps > 0).all():
        return entry
    back = int(np.count_nonzero(steps < 0))
    if back:
        remarks.append(f"{entry.name!r}: {back} records were out of order; they were sorted by their times.")
        order = np.argsort(time, kind="stable")
        entry, time = replace(entry, records=entry.records[order]), time[order]
    last = np.append(np.diff(time) > 0, True)
    return replace(entry, records=entry.records[last])
