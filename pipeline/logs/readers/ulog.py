"""ULog of PX4: https://docs.px4.io/main/en/dev_log/ulog_file_format.html.

`pyulog` reads what is rare: definitions, parameters, and one record of each topic, which gives the layout of its
records. It takes records one by one, though (some 0.6 million a second), and a log is little else than records; those
are collected here.
"""

import contextlib
import io
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap import compiled
from simgap.errors import InputError
from simgap.logs.log import Log
from simgap.logs.readers.file_bytes import bytes_of
from simgap.logs.readers.packed import Packed
from simgap.logs.readers.ulog_formats import within_bounds
from simgap.logs.records import Records, RecordSignals

MAGIC = b"ULog\x01\x12\x35"
_SYNC = b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"
_HEADER = 16  # bytes before the first message
_HEAD = struct.Struct("<HBH")  # of a message: size, type, and the message id of a record
_SHORTEST = 3  # bytes of a message
_RECORD = ord("D")
_TYPES = {
    "int8_t": "i1", "uint8_t": "u1", "int16_t": "<i2", "uint16_t": "<u2", "int32_t": "<i4", "uint32_t": "<u4",
    "int64_t": "<i8", "uint64_t": "<u8", "float": "<f4", "double": "<f8", "bool": "i1", "char": "i1",
}  # fmt: skip
_FACTS = ("SYS_AUTOSTART", "MAV_TYPE", "CA_", "PWM_", "THR_MDL_FAC", "SDLOG_PROFILE")
_REMEDY = "copy it from the vehicle again"


@dataclass
class _Parts:
    """A file's messages: the records by message id, all bytes of one in a row, and all others."""

    records: dict[int, NDArray[np.uint8]] = field(default_factory=dict)
    first: dict[int, bytes] = field(default_factory=dict)
    others: list[tuple[int, bytes]] = field(default_factory=list)
    dropouts: list[int] = field(default_factory=list)
    damaged: int = 0


def read(path: Path) -> Log:
    """Read a ULog; a signal is called `topic.field`, and `topic[1].field` from the second instance of a topic on.

    The clock begins where the log begins. What was logged before has a time below zero.

    Raises:
        InputError: when the file is damaged, no ULog, or of a newer version.
    """
    data = bytes_of(path)
    parts = _split(data, path)
    ulog = _parsed(data[:_HEADER], parts, path)
    start = ulog.start_timestamp
    fields: dict[str, tuple[Records, str]] = {}
    left_out = []
    for topic in ulog.data_list:
        records = _records(topic, parts, start)
        prefix = topic.name + (f"[{topic.multi_id}]" if topic.multi_id else "")
        if records is None:
            left_out.append(prefix)
            continue
        for entry in topic.field_data:
            if entry.type_str != "char" and not entry.field_name.startswith(("timestamp", "_padding")):
                fields[f"{prefix}.{entry.field_name}"] = (records, entry.field_name)
    if not fields:
        raise InputError("holds no records that can be read", str(path), _REMEDY)
    return Log(
        "PX4 ULog", str(path), RecordSignals(fields), facts=_facts(ulog), remarks=_remarks(parts, left_out)
    )


def _split(data: bytes, path: Path) -> _Parts:
    """Sort the messages of a file, and of what was appended to it after a crash."""
    if len(data) < _HEADER or not data.startswith(MAGIC):
        raise InputError("is no ULog", str(path), _REMEDY)
    parts = _Parts()
    places = _places(data, parts)
    are_records = np.frombuffer(data, np.uint8)[places + 2] == _RECORD
    _sort_records(data, places[are_records], parts)
    for at in places[~are_records].tolist():
        size, kind, number = _HEAD.unpack_from(data, at)
        if kind == ord("O") and size >= 2:
            parts.dropouts.append(number)
        elif kind != ord("S"):
            parts.others.append((kind, data[at : at + 3 + size]))
    return parts


def _appended(data: bytes) -> list[int]:
    """Return where appended sections begin, of the flag bits that come first; none where they are not set."""
    if len(data) < _HEADER + 43 or data[_HEADER + 2] != ord("B") or not data[_HEADER + 11] & 1:
        return []
    return sorted(set(struct.unpack_from("<3Q", data, _HEADER + 19)))


def _places(data: bytes, parts: _Parts) -> NDArray[np.int64]:
    """Return where messages begin; after damage it goes on at the next mark of synchronisation."""
    walk = compiled.for_size(_walk, len(data))
    offsets = [at for at in _appended(data) if _HEADER < at < len(data)]
    found, places = 0, np.empty(len(data) // _SHORTEST + 1, dtype=np.int64)
    for at, end in zip([_HEADER, *offsets], [*offsets, len(data)], strict=True):
        while at + 5 <= end:
            found, at = walk(memoryview(data), at, end, places.data, found)
            if at + 5 <= end:
                stop = at + 3 + int.from_bytes(data[at : at + 2], "little")
                parts.damaged += stop < len(data)  # a file that ends in a message was cut, which is no damage
                mark = data.find(_SYNC, at + 1, end)
                at = mark + len(_SYNC) if mark >= 0 else end
    return places[:found]


def _walk(data: memoryview, at: int, end: int, places: memoryview, found: int) -> tuple[int, int]:
    """Put down where messages begin, behind those found before; return how many, and the place where none is.

    It can be compiled: `simgap.compiled`.
    """
    while at + 5 <= end:
        size, kind = data[at] + 256 * data[at + 1], data[at + 2]
        # Every type is a capital letter; a record, D, may be empty.
        if not 65 <= kind <= 90 or (size == 0 and kind != 68) or at + 3 + size > end:
            break
        places[found] = at
        found += 1
        at += 3 + size
    return found, at


def _sort_records(data: bytes, places: NDArray[np.int64], parts: _Parts) -> None:
    """Sort the records that begin at some places by their message ids; those of another size than the first are
    damaged."""
    raw = np.frombuffer(data, np.uint8)
    words = np.ndarray((len(data) - 1,), dtype="<u2", buffer=data, strides=(1,))
    sizes, numbers = words[places], words[places + 3]
    order = np.argsort(numbers, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(numbers[order])) + 1) if len(order) else []
    for rows in sorted((rows[sizes[rows] > 2] for rows in groups), key=lambda rows: rows[:1].tolist()):
        if len(rows):
            size, number, begin = int(sizes[rows[0]]), int(numbers[rows[0]]), int(places[rows[0]])
            begins = places[rows[sizes[rows] == size]] + 5
            parts.records[number] = Packed(raw, begins, np.full(len(begins), size - 2)).alike()
            parts.first[number] = data[begin : begin + 3 + size]
    parts.damaged += len(places) - sum(len(rows) for rows in parts.records.values())


def _parsed(header: bytes, parts: _Parts, path: Path) -> Any:
    """Let pyulog read the definitions, parameters and one record of each topic."""
    from pyulog import ULog

    numbers = set(parts.first)
    kept = list(within_bounds(parts.others, numbers))
    if ord("A") not in (kind for kind, _ in kept):
        raise InputError("holds no records that can be read", str(path), _REMEDY)
    plain = [_plain(kind, message) for kind, message in kept]
    text = io.BytesIO(header + b"".join(plain) + b"".join(parts.first.values()))
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # it prints its warnings
            return ULog(text)
    except Exception as error:  # a damaged file raises whatever its bytes lead to
        raise InputError(f"cannot be read ({error or type(error).__name__})", str(path), _REMEDY) from None


def _plain(kind: int, message: bytes) -> bytes:
    """Return a message; the flag bits without the places of appended sections, which are no longer apart."""
    if kind != ord("B") or len(message) < 43:
        return message
    return message[:11] + bytes([message[11] & ~1]) + message[12:19] + bytes(24) + message[43:]


def _records(topic: Any, parts: _Parts, start: int) -> Records | None:
    """Return the records of a topic; None where they do not fit its format."""
    content = parts.records[topic.msg_id]
    size = content.shape[1]
    types = [_TYPES[entry.type_str] for entry in topic.field_data]
    names = [entry.field_name for entry in topic.field_data]
    widths = [np.dtype(kind).itemsize for kind in types]
    if sum(widths) > size or len(set(names)) < len(names) or "timestamp" not in names:
        return None
    offsets = np.cumsum([0, *widths[:-1]]).tolist()
    layout = np.dtype({"names": names, "formats": types, "offsets": offsets, "itemsize": size})  # type: ignore[call-overload]
    rows = content.view(layout)[:, 0]
    stamp = rows["timestamp"]
    time = 1e-6 * (stamp - np.uint64(start)).astype("int64") if stamp.dtype == "<u8" else 1e-6 * stamp
    flags = frozenset(entry.field_name for entry in topic.field_data if entry.type_str == "bool")
    return Records(rows, time, held=flags)


def _facts(ulog: Any) -> dict[str, str]:
    told = {"software": "sys_name", "hardware": "ver_hw", "commit": "ver_sw"}
    facts = {name: str(ulog.msg_info_dict[key]) for name, key in told.items() if key in ulog.msg_info_dict}
    version = ulog.msg_info_dict.get("ver_sw_release")
    if isinstance(version, int):
        facts["version"] = ".".join(str(version >> shift & 0xFF) for shift in (24, 16, 8))
    for name, value in sorted(ulog.initial_parameters.items()):
        if name.startswith(_FACTS) and isinstance(value, int | float):
            facts[name] = f"{value:.6g}"
    return facts


def _remarks(parts: _Parts, left_out: list[str]) -> tuple[str, ...]:
    remarks = []
    if parts.dropouts:
        seconds = sum(parts.dropouts) / 1000
        remarks.append(
            f"The logger lost data {len(parts.dropouts)} times, {seconds:.3g} s in all; the gaps are kept."
        )
    if parts.damaged:
        remarks.append(f"The file is damaged in {parts.damaged} places; what could not be read is left out.")
    if left_out:
        remarks.append(f"Left out, since the records do not fit their format: {', '.join(left_out)}.")
    return tuple(remarks)
