"""Writes DataFlash logs: FMT records, units and counters of instances, records in the order of their times."""

import struct
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

Columns = Mapping[str, Sequence[Any]]

_CODES = {letter: letter for letter in "QIfBhHbd"} | {
    "c": "h", "C": "H", "L": "i", "n": "4s", "N": "16s", "Z": "64s",
}  # fmt: skip
_SCALED = {"c": 100, "C": 100, "L": 1e7}
_FIRST = 140  # type of the first message
_LABELS = {"#": b"instance", "k": b"deg/s", "o": b"m/s/s", "v": b"V", "-": b""}


def dataflash(
    messages: Mapping[str, tuple[str, Columns]],
    parameters: Mapping[str, float] | None = None,
    texts: Sequence[str] = ("ArduCopter V4.5.0 (00000000)", "Frame: QUAD/X"),
    units: Mapping[str, str] | None = None,
) -> bytes:
    """Return a file.

    Args:
        messages: name to the letters of its format, and column to values; the first column is TimeUS or TimeMS.
        parameters: name to value.
        texts: for the pilot.
        units: message to a letter for each column; `#` counts instances, k is deg/s, o m/s/s, - nothing.
    """
    everything = _told(parameters or {}, texts) | (_UNIT if units else {})
    if units:
        names = [*everything, "FMTU", *messages]
        everything["FMTU"] = _declared(units, {name: _FIRST + place for place, name in enumerate(names)})
    everything |= messages
    head = [_format(128, "FMT", "BBnNZ", ["Type", "Length", "Name", "Format", "Columns"])]
    records: list[tuple[float, bytes]] = []
    for kind, (name, (letters, columns)) in enumerate(everything.items(), _FIRST):
        head.append(_format(kind, name, letters, list(columns)))
        records += _records(kind, letters, columns)
    records.sort(key=lambda record: record[0])
    return b"".join([*head, *(record for _, record in records)])


def _told(parameters: Mapping[str, float], texts: Sequence[str]) -> dict[str, tuple[str, Columns]]:
    told: dict[str, tuple[str, Columns]] = {}
    if texts:
        told["MSG"] = ("QZ", {"TimeUS": [0] * len(texts), "Message": [text.encode() for text in texts]})
    if parameters:
        names = [name.encode() for name in parameters]
        told["PARM"] = ("QNf", {"TimeUS": [0] * len(names), "Name": names, "Value": [*parameters.values()]})
    return told


_UNIT: dict[str, tuple[str, Columns]] = {
    "UNIT": (
        "QbZ",
        {"TimeUS": [0] * len(_LABELS), "Id": [ord(key) for key in _LABELS], "Label": [*_LABELS.values()]},
    )
}


def _declared(units: Mapping[str, str], kinds: Mapping[str, int]) -> tuple[str, Columns]:
    return "QBNN", {
        "TimeUS": [0] * len(units),
        "FmtType": [kinds[name] for name in units],
        "UnitIds": [letters.encode() for letters in units.values()],
        "MultIds": [b"-" * len(letters) for letters in units.values()],
    }


def _records(kind: int, letters: str, columns: Columns) -> Iterator[tuple[float, bytes]]:
    packer = struct.Struct("<" + "".join(_CODES[letter] for letter in letters))
    to_us = 1000 if next(iter(columns)) == "TimeMS" else 1
    for row in zip(*columns.values(), strict=True):
        values = [_stored(value, letter) for value, letter in zip(row, letters, strict=True)]
        yield float(row[0]) * to_us, bytes([0xA3, 0x95, kind]) + packer.pack(*values)


def _stored(value: Any, letter: str) -> Any:
    if letter in "NZn":
        return value
    return float(value) if letter in "fd" else round(float(value) * _SCALED.get(letter, 1))


def _format(kind: int, name: str, letters: str, columns: list[str]) -> bytes:
    length = 3 + struct.calcsize("<" + "".join(_CODES[letter] for letter in letters))
    texts = (name.encode(), letters.encode(), ",".join(columns).encode())
    return struct.pack("<BBBBB4s16s64s", 0xA3, 0x95, 128, kind, length, *texts)


def instances(*numbered: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the columns of several instances as one message, with the counter I, in the order of time."""
    counter = np.concatenate([np.full(len(part["TimeUS"]), number) for number, part in enumerate(numbered)])
    joined = {name: np.concatenate([part[name] for part in numbered]) for name in numbered[0]}
    order = np.argsort(joined["TimeUS"], kind="stable")
    return {"TimeUS": joined["TimeUS"][order], "I": counter[order]} | {
        name: values[order] for name, values in joined.items() if name != "TimeUS"
    }
