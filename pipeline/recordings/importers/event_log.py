"""Binary event logs that Bitcraze's micro-SD deck writes (cfusdlog, versions 1 and 2).

Source: tools/usdlog of bitcraze/crazyflie-firmware.
"""

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from simgap import compiled
from simgap.errors import InputError

_MAGIC = 0xBC
_NUMBER, _TIME = "event", "timestamp"
_CLOCKS = {1: ("<u4", 1000), 2: ("<u8", 1)}  # version to the type of a timestamp, and µs of one step of it
_TYPES = {
    "b": "<i1",
    "B": "<u1",
    "h": "<i2",
    "H": "<u2",
    "i": "<i4",
    "I": "<u4",
    "q": "<i8",
    "Q": "<u8",
    "e": "<f2",
    "f": "<f4",
    "d": "<f8",
}
_NUMBERS = 1 << 16  # that a type of events may have
_CHECKSUM = 4  # bytes at the end


@dataclass(frozen=True)
class EventLog:
    """The events of a log.

    Attributes:
        events: name of a type of events to its records, structured: `timestamp` and the variables.
        step: µs of one step of a timestamp.
        whole: whether the checksum is right; a log that was cut off has none.
    """

    events: Mapping[str, np.ndarray]
    step: int
    whole: bool

    def time(self, name: str) -> np.ndarray:
        """Return the times of a type of events, µs."""
        return self.events[name][_TIME].astype(np.uint64) * np.uint64(self.step)

    def variables(self, name: str) -> list[str]:
        """Return the names of the variables of a type of events."""
        return [column for column in self.events[name].dtype.names or () if column not in (_NUMBER, _TIME)]


def read_event_log(path: Path) -> pd.DataFrame:
    """Return `timestamp` (µs) and the variables of a log that holds one type of event, a row each.

    Raises:
        InputError: when the file is damaged, cut off, not of this format, or holds several types of events.
    """
    log = read_events(path)
    if not log.whole:
        raise InputError("its checksum is wrong", str(path), "it was cut off or damaged; copy it again")
    if len(log.events) != 1:
        raise InputError(f"holds {len(log.events)} types of events", str(path), "give a log with one")
    name, events = next(iter(log.events.items()))
    return pd.DataFrame({_TIME: log.time(name)} | {column: events[column] for column in log.variables(name)})


def read_events(path: Path) -> EventLog:
    """Return the events of a log, by type.

    A file is a header (magic, version, number of event types; of each its number, its name and its variables, each
    written as name(type)), the events (number, timestamp, values) and a CRC-32 of all before.

    Raises:
        InputError: when the file is damaged, empty or not of this format.
    """
    where = str(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where, "check its path") from None
    if not content or content[0] != _MAGIC:
        raise InputError("is not a log of the micro-SD deck", where, "give the file as the deck wrote it")
    body = memoryview(content)[:-_CHECKSUM]
    whole = zlib.crc32(body) == int.from_bytes(content[-_CHECKSUM:], "little")
    if not whole:
        body = memoryview(content)
    try:
        types, step, start = _header(content)
    except (struct.error, KeyError, ValueError) as error:
        raise InputError(
            f"its header cannot be read ({error})", where, "give a log of version 1 or 2"
        ) from None
    places, end = _places(body, types, start)
    if not whole and _goes_on(body, types, end):
        raise InputError("its checksum is wrong", where, "it was damaged; copy it again")
    if not any(len(starts) for starts in places.values()) or (whole and end != len(body)):
        raise InputError("does not end with a whole event", where, "it was cut off or damaged; copy it again")
    events = {
        name: _gathered(body, places[number], record)
        for number, (name, record) in types.items()
        if len(places[number])
    }
    return EventLog(events, step, whole)


def _header(body: bytes) -> tuple[dict[int, tuple[str, np.dtype]], int, int]:
    """Return number to (name, layout) of each type of events, µs of one step of time, where the first event begins."""
    version, count = struct.unpack_from("<HH", body, 1)
    if version not in _CLOCKS:
        raise ValueError(f"version {version}")
    clock, step = _CLOCKS[version]
    place = 5
    types: dict[int, tuple[str, np.dtype]] = {}
    for _ in range(count):
        (number,) = struct.unpack_from("<H", body, place)
        end = body.index(b"\0", place + 2)
        name = body[place + 2 : end].decode("ascii")
        (variables,) = struct.unpack_from("<H", body, end + 1)
        place = end + 3
        fields = [(_NUMBER, "<u2"), (_TIME, clock)]
        for _ in range(variables):
            end = body.index(b"\0", place)
            variable, _, kind = body[place:end].decode("ascii").rstrip(")").rpartition("(")
            fields.append((variable, _TYPES[kind]))
            place = end + 1
        if number in types or name in [other for other, _ in types.values()]:
            raise ValueError(f"the type of events {name!r} stands twice")
        types[number] = name, np.dtype(fields)
    return types, step, place


def _places(
    body: memoryview, types: Mapping[int, tuple[str, np.dtype]], start: int
) -> tuple[dict[int, np.ndarray], int]:
    """Return where the events of each type begin, and the end of the last one that is whole."""
    if len(types) == 1:
        number, (_, record) = next(iter(types.items()))
        rows = (len(body) - start) // record.itemsize
        numbers = np.frombuffer(body, record, rows, start)[_NUMBER]
        wrong = np.flatnonzero(numbers != number)
        rows = int(wrong[0]) if len(wrong) else rows
        end = start + rows * record.itemsize
        return {number: np.arange(start, end, record.itemsize)}, end
    sizes = np.zeros(_NUMBERS, dtype=np.int64)
    for number, (_, record) in types.items():
        sizes[number] = record.itemsize
    shortest = min((record.itemsize for _, record in types.values()), default=1)
    found = np.empty(1 + max(0, len(body) - start) // shortest, np.int64)
    walk = compiled.for_size(_walk, len(body))
    count, end = walk(body, start, sizes.data, found.data)
    found = found[:count]
    numbers = np.ndarray((len(body) - 1,), "<u2", buffer=body, strides=(1,))[found]
    return {number: found[numbers == number] for number in types}, end


def _walk(body: memoryview, place: int, sizes: memoryview, found: memoryview) -> tuple[int, int]:
    """Put down where events begin; return how many, and the end of the last one that is whole.

    It can be compiled: `simgap.compiled`.
    """
    count, end = 0, len(body)
    while place + 2 <= end:
        size = sizes[body[place] + 256 * body[place + 1]]
        if size == 0 or place + size > end:
            break
        found[count] = place
        count += 1
        place += size
    return count, place


def _goes_on(body: memoryview, types: Mapping[int, tuple[str, np.dtype]], end: int) -> bool:
    """Whether what follows the last whole event is something else than the beginning of one."""
    if len(body) - end < 2:
        return False
    record = types.get(int.from_bytes(body[end : end + 2], "little"))
    return record is None or len(body) - end >= record[1].itemsize


def _gathered(body: memoryview, starts: np.ndarray, record: np.dtype) -> np.ndarray:
    """Return the events that begin at some places."""
    size = record.itemsize  # at every byte an event could begin
    everywhere = np.ndarray((len(body) - size + 1,), f"V{size}", buffer=body, strides=(1,))
    return everywhere[starts].view(record)
