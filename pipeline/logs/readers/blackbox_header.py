"""The headers of the logs in a blackbox file: which fields each kind of frame has, and how they are predicted.

Source: "Blackbox logging internals", betaflight.com/docs/development/blackbox-internals.
"""

import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

START = b"H Product:Blackbox flight data recorder by Nicholas Sherlock"
"""First line of each log in a file."""

_LONGEST_HEADER = 1 << 16  # bytes; the headers of present firmware have some 8 kB
_MOST_FIELDS = 256  # of a frame; present firmware logs at most about a hundred
_ENCODINGS = (0, 1, 3, 6, 7, 8, 9, 10)
_PREDICTORS = tuple(range(12))
_LONGEST_INTERVAL = 1 << 16  # loops between two frames

Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Frames:
    """The fields of one kind of frame.

    Attributes:
        names: of the fields.
        table: encoding, predictor and sign (1: has one) of each field, (3, fields).
    """

    names: tuple[str, ...]
    table: Integers


@dataclass(frozen=True)
class Header:
    """The header of one log.

    Attributes:
        facts: its lines, by name.
        end: place of the first frame in the file.
        frames: kind of frame (I, P, S, G, H) to its fields; those that the log does not define are absent.
    """

    facts: Mapping[str, str]
    end: int
    frames: Mapping[str, Frames]

    def table(self, kind: str) -> Integers:
        """Return encoding, predictor and sign of the fields of a kind of frame, (3, fields); (3, 0) where absent."""
        return self.frames[kind].table if kind in self.frames else np.zeros((3, 0), dtype=np.int64)

    def numbers(self, name: str) -> list[float]:
        """Return the numbers of a line, which are separated by commas; none where it is absent or no numbers."""
        found = []
        for text in self.facts.get(name, "").split(","):
            try:
                found.append(float(text))
            except ValueError:
                return []
        return found

    def number(self, name: str, default: float) -> float:
        """Return the first number of a line."""
        return next(iter(self.numbers(name)), default)

    @property
    def gyro_scale(self) -> float | None:
        """What one step of the gyroscope is, as the header has it: a 32-bit float written as hexadecimal number."""
        text = self.facts.get("gyro_scale", self.facts.get("gyro.scale", ""))
        if not re.fullmatch(r"0x[0-9a-fA-F]{8}", text):
            return None
        return float(struct.unpack(">f", bytes.fromhex(text[2:]))[0])

    @property
    def firmware(self) -> tuple[str, float]:
        """Name and version of the firmware, such as ("Betaflight", 4.2); ("", 0) where it is not said."""
        found = re.match(r"(\w+)\W+v?(\d+\.\d+)", self.facts.get("Firmware revision", ""))
        return (found[1], float(found[2])) if found else ("", 0.0)


def starts_of(data: bytes) -> list[int]:
    """Return where the logs in a file begin."""
    return [found.start() for found in re.finditer(re.escape(START), data)]


def header_of(data: bytes, start: int, end: int) -> Header | None:
    """Return the header of the log that lies between two places; None where it does not say how to decode the log."""
    facts: dict[str, str] = {}
    at = start
    while at < min(end, start + _LONGEST_HEADER) and data[at : at + 2] == b"H ":
        line_end = data.find(b"\n", at, end)
        line = data[at + 2 : line_end]
        if line_end < 0 or b":" not in line or not line.isascii():
            break
        name, _, value = line.decode("ascii").partition(":")
        facts[name.strip()] = value.strip()
        at = line_end + 1
    frames = {kind: found for kind in "IPSGH" if (found := _frames(facts, kind)) is not None}
    known = "I" in frames and "P" in frames and "time" in frames["I"].names
    return Header(facts, at, frames) if known else None


def settings_of(header: Header) -> Integers:
    """Return what predictors need of a header, in the order of `simgap.logs.readers.blackbox_frames`."""
    names = header.frames["I"].names
    shares = re.match(r"(\d+)(?:/(\d+))?", header.facts.get("P interval", "1/1"))
    first, second = (int(shares[1]), shares[2]) if shares else (1, "1")
    # Betaflight writes every how many loops a frame is logged; older firmware a fraction of the loops
    numerator, denominator = (first, int(second)) if second else (1, first)
    motor = names.index("motor[0]") if "motor[0]" in names else 0
    values = [
        header.number("minthrottle", 0.0),
        header.number("vbatref", 0.0),
        header.number("motorOutput", 0.0),
        _interval(numerator),
        _interval(denominator),
        _interval(header.number("I interval", 1.0)),
        names.index("time"),
        motor,
    ]
    return np.array([int(value) for value in values], dtype=np.int64)


def _interval(number: float | int) -> float | int:
    return min(max(number, 1.0), _LONGEST_INTERVAL)


def _frames(facts: Mapping[str, str], kind: str) -> Frames | None:
    """Return the fields of one kind of frame; None where they are not defined, or by numbers that nobody knows."""
    like = "I" if kind == "P" else kind  # the frames between have the fields of the key frames
    names = tuple(facts.get(f"Field {like} name", "").split(","))
    rows = [_integers(facts.get(f"Field {kind} {word}", "")) for word in ("encoding", "predictor")]
    signs = _integers(facts.get(f"Field {like} signed", ",".join("0" for _ in names)))
    if any(len(row) != len(names) for row in (*rows, signs)) or not 0 < len(names) <= _MOST_FIELDS:
        return None
    if not set(rows[0]) <= set(_ENCODINGS) or not set(rows[1]) <= set(_PREDICTORS):
        return None
    return Frames(names, np.array([*rows, signs], dtype=np.int64))


def _integers(text: str) -> list[int]:
    parts = text.split(",")
    return [int(part) for part in parts] if all(re.fullmatch(r"\d{1,3}", part) for part in parts) else []
