"""Writes DataFlash logs: FMT records, units and counters of instances, records in the order of their times."""

import struct
from collections.abc import Mapping, Sequence

import numpy as np

_CODES = {
    "Q": "Q",
    "I": "I",
    "f": "f",
    "B": "B",
    "h": "h",
    "H": "H",
    "c": "h",
    "C": "H",
    "L": "i",
    "N": "16s",
    "Z": "64s",
    "b": "b",
    "n": "4s",
    "d": "d",
}
_SCALED = {"c": 100, "C": 100, "L": 1e7}


def dataflash(
    messages: Mapping[str, tuple[str, Mapping[str, Sequence]]],
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
    everything: dict[str, tuple[str, Mapping[str, Sequence]]] = {}
    if texts:
        everything["MSG"] = ("QZ", {"TimeUS": [0] * len(texts), "Message": [text.encode() for text in texts]})
    if parameters:
        names = [name.encode() for name in parameters]
        everything["PARM"] = (
            "QNf",
            {"TimeUS": [0] * len(names), "Name": names, "Value": list(parameters.values())},
        )
    if units:
        labels = {"#": b"instance", "k": b"deg/s", "o": b"m/s/s", "v": b"V", "-": b""}
        everything["UNIT"] = (
            "QbZ",
            {"TimeUS": [0] * len(labels), "Id": [ord(key) for key in labels], "Label": list(labels.values())},
        )
        kinds = {name: 140 + number for number, name in enumerate([*everything, "FMTU", *messages])}
        everything["FMTU"] = (
            "QBNN",
            {
                "TimeUS": [0] * len(units),
                "FmtType": [kinds[name] for name in units],
                "UnitIds": [text.encode() for text in units.values()],
                "MultIds": [b"-" * len(text) for text in units.values()],
            },
        )
    everything |= messages
    head, records = [_format(128, "FMT", "BBnNZ", ["Type", "Length", "Name", "Format", "Columns"])], []
    for number, (name, (letters, columns)) in enumerate(everything.items()):
        kind = 140 + number
        head.append(_format(kind, name, letters, list(columns)))
        packer = struct.Struct("<" + "".join(_CODES[letter] for letter in letters))
        scales = [_SCALED.get(letter) for letter in letters]
        for row in zip(*columns.values(), strict=True):
            values = [
                _stored(value, letter, scale)
                for value, letter, scale in zip(row, letters, scales, strict=True)
            ]
            time = float(row[0]) * (1000 if next(iter(columns)) == "TimeMS" else 1)
            records.append((time, bytes([0xA3, 0x95, kind]) + packer.pack(*values)))
    records.sort(key=lambda record: record[0])
    return b"".join([*head, *(record for _, record in records)])


def _stored(value, letter: str, scale: float | None):
    if letter in "NZn":
        return value
    if letter in "fd":
        return float(value)
    return round(float(value) * (scale or 1))


def _format(kind: int, name: str, letters: str, columns: list[str]) -> bytes:
    length = 3 + struct.calcsize("<" + "".join(_CODES[letter] for letter in letters))
    return struct.pack(
        "<BBBBB4s16s64s",
        0xA3,
        0x95,
        128,
        kind,
        length,
        name.encode(),
        letters.encode(),
        ",".join(columns).encode(),
    )


def instances(*numbered: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the columns of several instances as one message, with the counter I, in the order of time."""
    counter = np.concatenate([np.full(len(part["TimeUS"]), number) for number, part in enumerate(numbered)])
    joined = {name: np.concatenate([part[name] for part in numbered]) for name in numbered[0]}
    order = np.argsort(joined["TimeUS"], kind="stable")
    return {"TimeUS": joined["TimeUS"][order], "I": counter[order]} | {
        name: values[order] for name, values in joined.items() if name != "TimeUS"
    }
