"""Writes ULog files: header, flag bits, formats, parameters, subscriptions, records in the order of their times."""

import struct
from collections.abc import Mapping

import numpy as np

SYNC = b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"
_KINDS = {"f4": "float", "f8": "double", "u1": "uint8_t", "i4": "int32_t", "b1": "bool", "u8": "uint64_t"}


def message(kind: str, payload: bytes) -> bytes:
    return struct.pack("<HB", len(payload), ord(kind)) + payload


def info(key: str, value: bytes, kind: str = "I") -> bytes:
    return message(kind, bytes([len(key)]) + key.encode() + value)


def parameter(name: str, value: float) -> bytes:
    if isinstance(value, int):
        return info(f"int32_t {name}", struct.pack("<i", value), "P")
    return info(f"float {name}", struct.pack("<f", value), "P")


def ulog(
    topics: Mapping[str, Mapping[str, np.ndarray]],
    parameters: Mapping[str, float] | None = None,
    start: int = 1_000_000,
    dropouts: Mapping[int, int] | None = None,
    cut_at: int | None = None,
) -> bytes:
    """Return a file.

    Args:
        topics: `name` or `name[1]` to field to values (n,) or (n, k); `timestamp` is in µs.
        parameters: initial ones.
        start: time stamp of the beginning, µs.
        dropouts: number of the record to ms lost before it.
        cut_at: number of the record from which on the file is an appended section.
    """
    formats, subscriptions, records = [], [], []
    defined: set[str] = set()
    for number, (name, fields) in enumerate(topics.items()):
        topic, _, instance = name.rstrip("]").partition("[")
        rows = _rows(fields)
        if topic not in defined:
            defined.add(topic)
            formats.append(message("F", _format(topic, rows.dtype).encode()))
        subscriptions.append(message("A", struct.pack("<BH", int(instance or 0), number) + topic.encode()))
        records += [
            (int(row["timestamp"]), message("D", struct.pack("<H", number) + row.tobytes())) for row in rows
        ]
    records.sort(key=lambda record: record[0])
    head = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", start)
    body = b"".join([*formats, *(parameter(*pair) for pair in (parameters or {}).items())])
    body += info("char[3] sys_name", b"PX4") + b"".join(subscriptions)
    before, after = _data(records, dropouts or {}, cut_at)
    appended = len(head) + 43 + len(body) + len(before) if cut_at is not None else 0
    flags = bytes(8) + bytes([bool(appended)]) + bytes(7) + struct.pack("<3Q", appended, 0, 0)
    return head + message("B", flags) + body + before + after


def _data(
    records: list[tuple[int, bytes]], dropouts: Mapping[int, int], cut_at: int | None
) -> tuple[bytes, bytes]:
    parts: list[list[bytes]] = [[], []]
    for number, (_, record) in enumerate(records):
        part = parts[cut_at is not None and number >= cut_at]
        if number in dropouts:
            part.append(message("O", struct.pack("<H", dropouts[number])))
        if number % 50 == 0:
            part.append(message("S", SYNC))
        part.append(record)
    if cut_at is not None:
        parts[0].append(records[cut_at][1][:9])  # what was written when it crashed
    return b"".join(parts[0]), b"".join(parts[1])


def _rows(fields: Mapping[str, np.ndarray]) -> np.ndarray:
    kinds = [
        (
            name,
            "u8" if name == "timestamp" else np.asarray(values).dtype.str.lstrip("<|"),
            np.shape(values)[1:],
        )
        for name, values in fields.items()
    ]
    rows = np.zeros(len(fields["timestamp"]), dtype=np.dtype(kinds))
    for name, values in fields.items():
        rows[name] = values
    return rows


def _format(topic: str, layout: np.dtype) -> str:
    shown = []
    for name in layout.names or ():
        kind, shape = layout[name].base, layout[name].shape
        shown.append(f"{_KINDS[kind.str.lstrip('<|')]}{f'[{shape[0]}]' if shape else ''} {name};")
    return f"{topic}:{''.join(shown)}"
