"""Writes small WPILib DataLogs, by the published format and not by the reader."""

import json
import struct
from pathlib import Path

import numpy as np


class Writer:
    """Collects records; `write` puts them into a file."""

    def __init__(self, text: str = "") -> None:
        header = text.encode()
        self.parts = [b"WPILOG", struct.pack("<HI", 0x0100, len(header)), header]
        self.last = 0

    def start(self, name: str, kind: str, metadata: str = "", number: int | None = None) -> int:
        self.last = self.last + 1 if number is None else number
        texts = b"".join(
            struct.pack("<I", len(text.encode())) + text.encode() for text in (name, kind, metadata)
        )
        self.record(0, 0, b"\0" + struct.pack("<I", self.last) + texts)
        return self.last

    def finish(self, number: int) -> None:
        self.record(0, 0, b"\1" + struct.pack("<I", number))

    def record(self, number: int, time: int, content: bytes) -> None:
        """Write a record with the shortest fields that hold its numbers; time in µs."""
        fields = [_shortest(number, 4), _shortest(len(content), 4), _shortest(time % (1 << 64), 8)]
        lengths = [len(field) - 1 for field in fields]
        self.parts += [bytes([lengths[0] | lengths[1] << 2 | lengths[2] << 4]), *fields, content]

    def double(self, number: int, time: int, *values: float) -> None:
        self.record(number, time, struct.pack(f"<{len(values)}d", *values))

    def text(self, number: int, time: int, value: str) -> None:
        self.record(number, time, value.encode())

    def doubles(self, name: str, times: np.ndarray, values: np.ndarray, metadata: str = "") -> int:
        """Write a whole signal; times in s."""
        number = self.start(name, "double", metadata)
        for time, value in zip(times, values, strict=True):
            self.double(number, round(float(time) * 1e6), float(value))
        return number

    def struct_schema(self, name: str, schema: str) -> None:
        number = self.start(f"/.schema/struct:{name}", "structschema")
        self.text(number, 0, schema)

    def bytes(self) -> bytes:
        return b"".join(self.parts)

    def write(self, path: Path) -> Path:
        path.write_bytes(self.bytes())
        return path


def unit(name: str) -> str:
    return json.dumps({"source": "AdvantageKit", "unit": name})


def _shortest(number: int, most: int) -> bytes:
    length = next(count for count in range(1, most + 1) if number < 1 << 8 * count)
    return number.to_bytes(length, "little")
