"""DataFlash logs of ArduPilot (`.bin`): https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html.

The log describes itself: a record is two marks, its type and its fields, and records of the type FMT say which fields
a type has. `pymavlink`, the usual reader, takes 0.13 million records a second, needs an XML library, and is LGPL; the
format is a table of letters, so it is read here, all records of a type at once.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.log import Log
from simgap.logs.readers.dataflash_facts import declared_units, facts_of
from simgap.logs.readers.dataflash_signals import signals_of
from simgap.logs.readers.file_bytes import bytes_of

MARKS = b"\xa3\x95"
FORMAT_TYPE = 128  # of the records that describe the others
_FORMAT = np.dtype(
    {
        "names": ["type", "length", "name", "letters", "columns"],
        "formats": ["u1", "u1", "S4", "S16", "S64"],
        "offsets": [3, 4, 5, 9, 25],
        "itemsize": 89,
    }
)
_LETTERS: dict[str, tuple[str, float]] = {
    "b": ("i1", 1.0), "B": ("u1", 1.0), "h": ("<i2", 1.0), "H": ("<u2", 1.0), "i": ("<i4", 1.0),
    "I": ("<u4", 1.0), "q": ("<i8", 1.0), "Q": ("<u8", 1.0), "f": ("<f4", 1.0), "d": ("<f8", 1.0),
    "g": ("<f2", 1.0), "c": ("<i2", 1e-2), "C": ("<u2", 1e-2), "e": ("<i4", 1e-2), "E": ("<u4", 1e-2),
    "L": ("<i4", 1e-7), "M": ("u1", 1.0), "n": ("S4", 1.0), "N": ("S16", 1.0), "Z": ("S64", 1.0),
    "a": ("(32,)<i2", 1.0),
}  # fmt: skip

_Layout = tuple[str, np.dtype[Any], dict[str, float]]
"""Name of a message, layout of its records, and scales of the fields that are stored as multiples."""


@dataclass(frozen=True)
class Message:
    """The records of one type.

    Attributes:
        name: as ATT.
        rows: one structured value a record, (n,).
        scales: of the fields that are stored as multiples.
        starts: places in the file, (n,).
    """

    name: str
    rows: NDArray[Any]
    scales: dict[str, float]
    starts: NDArray[np.int64]


def read(path: Path) -> Log:
    """Read a DataFlash log; a signal is called `ATT.Roll`, and `IMU[1].GyrX` from the second instance on.

    The clock is that of the vehicle, s since it was switched on. `ATT.quaternion.w` to `z` are computed of the angles
    of ATT: the attitude scalar first, from the body (forward, right, down) to the world (north, east, down).

    Raises:
        InputError: when the file is damaged, or no DataFlash log.
    """
    data = np.frombuffer(bytes_of(path), dtype=np.uint8)
    layouts = _layouts(data)
    if not layouts:
        raise InputError("is no DataFlash log of ArduPilot", str(path), "copy it from the vehicle again")
    starts, kinds = _records(data, layouts)
    messages = {
        message.name: message for message in _messages(data, starts, kinds, layouts) if len(message.rows)
    }
    lost = len(data) - int(sum(len(message.rows) * message.rows.itemsize for message in messages.values()))
    remarks = (f"{lost} bytes belong to no record and are left out.",) if lost else ()
    return Log(
        "ArduPilot DataFlash",
        str(path),
        signals_of(messages, declared_units(messages)),
        facts=facts_of(messages),
        remarks=remarks,
    )


def _layouts(data: NDArray[np.uint8]) -> dict[int, _Layout]:
    """Return type to name, layout and scales, of all records that describe a type."""
    starts = _marked(data)
    starts = starts[(starts + _FORMAT.itemsize <= len(data))]
    starts = starts[data[starts + 2] == FORMAT_TYPE]
    found: dict[int, _Layout] = {}
    for entry in _gather(data, starts, _FORMAT):
        layout = _layout(entry)
        if layout is not None:
            found.setdefault(int(entry["type"]), layout)
    return found


def _layout(entry: Any) -> _Layout | None:
    """Return what one FMT record says; None where it contradicts itself."""
    name = entry["name"].decode("ascii", "replace")
    letters = entry["letters"].decode("ascii", "replace")
    columns = entry["columns"].decode("ascii", "replace").split(",")
    if not name.isidentifier() or len(columns) != len(letters) or len(set(columns)) < len(columns):
        return None
    if not all(letter in _LETTERS for letter in letters) or not all(map(str.isidentifier, columns)):
        return None
    kinds = [np.dtype(_LETTERS[letter][0]) for letter in letters]
    if 3 + sum(kind.itemsize for kind in kinds) != int(entry["length"]):
        return None
    offsets = (3 + np.cumsum([0, *(kind.itemsize for kind in kinds[:-1])])).tolist()
    layout = np.dtype(
        {"names": columns, "formats": kinds, "offsets": offsets, "itemsize": int(entry["length"])}
    )
    scales = {column: _LETTERS[letter][1] for column, letter in zip(columns, letters, strict=True)}
    return name, layout, {column: scale for column, scale in scales.items() if scale != 1.0}


def _marked(data: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Return the places of the two marks with which a record begins."""
    first = np.flatnonzero(data[:-2] == MARKS[0])
    return first[data[first + 1] == MARKS[1]]


def _records(
    data: NDArray[np.uint8], layouts: dict[int, _Layout]
) -> tuple[NDArray[np.int64], NDArray[np.uint8]]:
    """Return the places and types of the records: marks of a known type, with other marks where the record ends.

    Two marks may stand inside of a record by chance. That another two stand where it would end is one in 65536.
    """
    lengths = np.zeros(256, dtype=np.int64)
    for kind, (_, layout, _) in layouts.items():
        lengths[kind] = layout.itemsize
    marks = _marked(data)
    marks = marks[lengths[data[marks + 2]] > 0]
    ends = marks + lengths[data[marks + 2]]
    places = np.append(marks, len(data))
    followed = places[np.minimum(np.searchsorted(places, ends), len(places) - 1)] == ends
    starts = marks[followed]
    return starts, data[starts + 2]


def _messages(
    data: NDArray[np.uint8],
    starts: NDArray[np.int64],
    kinds: NDArray[np.uint8],
    layouts: dict[int, _Layout],
) -> Iterator[Message]:
    order = np.argsort(kinds, kind="stable")
    edges = np.searchsorted(kinds[order], np.arange(257))
    for kind, (name, layout, scales) in layouts.items():
        own = starts[order[edges[kind] : edges[kind + 1]]]
        yield Message(name, _gather(data, own, layout), scales, own)


def _gather(data: NDArray[np.uint8], starts: NDArray[np.int64], layout: np.dtype[Any]) -> NDArray[Any]:
    if not len(starts):
        return np.empty(0, dtype=layout)
    windows = np.lib.stride_tricks.sliding_window_view(data, layout.itemsize)
    return np.ascontiguousarray(windows[starts]).view(layout).reshape(len(starts))
