"""Records of a WPILib DataLog: where each begins, of which entry it is, and when it was written.

Format: a header of 12 bytes and a text, then records. The first byte of a record says how many bytes its entry (bits 0
and 1), its size (2 and 3) and its time (4 to 6) take, each less one. Source: WPILib, "Data Log File Format
Specification, Version 1.0".
"""

import os
from array import array
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError

MAGIC = b"WPILOG"
_HEADER = 12  # bytes: the magic word, the version and the length of a text
_PADDING = (
    16  # bytes after the end, so that the longest header of a record (1 + 4 + 4 + 8) can be read anywhere
)
_ENTRY = [(bits & 3) + 1 for bits in range(128)]  # bytes of each field, by the first byte of a record
_SIZE = [((bits >> 2) & 3) + 1 for bits in range(128)]
_CHUNK = 1 << 16  # records at a time: their words need less memory than the file
_TIME = [((bits >> 4) & 7) + 1 for bits in range(128)]


@dataclass(frozen=True)
class Records:
    """The records of a file, in its order.

    Attributes:
        raw: bytes of the file, and some more.
        entry: number of the entry; 0 is a control record, (n,). Entry and size are as narrow as the file has them.
        begin: first byte of the content, whole numbers of 32 bits where these suffice, (n,).
        size: bytes of the content, (n,).
        time: µs, (n,).
        remarks: sentences about what was damaged.
    """

    raw: bytearray
    entry: NDArray[np.unsignedinteger[Any]]
    begin: NDArray[Any]
    size: NDArray[np.unsignedinteger[Any]]
    time: NDArray[np.int64]
    remarks: tuple[str, ...] = ()

    def content(self, record: int) -> bytes:
        """Return the content of one record."""
        begin = int(self.begin[record])
        return bytes(self.raw[begin : begin + int(self.size[record])])

    def numbers(self, dtype: str, places: NDArray[Any]) -> NDArray[Any]:
        """Return the numbers of a type that begin at bytes of the file, (n,)."""
        return _unaligned(self.raw, dtype)[places]


def read_records(path: Path) -> Records:
    """Read the records of a file; a damaged end is left out, and said.

    Raises:
        InputError: when it is no DataLog, or cannot be read.
    """
    raw, end = _bytes(path)
    if end < _HEADER or raw[: len(MAGIC)] != MAGIC:
        raise InputError("is no WPILib DataLog", str(path), "give a file that begins with WPILOG")
    if raw[7] != 1:  # the major version; 0.x and 2.x have another layout
        raise InputError(f"has version {raw[7]}.{raw[6]}", str(path), "give a DataLog of version 1")
    text = int.from_bytes(raw[8:12], "little")
    if text > end - _HEADER:
        raise InputError("ends within its header", str(path), "copy it from the robot again")
    places, remarks = _places(raw, _HEADER + text, end)
    bits = np.frombuffer(raw, np.uint8)[places]
    entry_bytes, size_bytes, time_bytes = (
        np.array(table, np.uint8)[bits] for table in (_ENTRY, _SIZE, _TIME)
    )
    places += 1
    entry = _field(raw, places, entry_bytes, _narrowest(entry_bytes))
    places += entry_bytes
    size = _field(raw, places, size_bytes, _narrowest(size_bytes))
    places += size_bytes
    time = _field(raw, places, time_bytes, np.dtype(np.uint64)).view(np.int64)
    places += time_bytes
    return Records(raw, entry, places, size, time, remarks)


def _bytes(path: Path) -> tuple[bytearray, int]:
    try:
        with path.open("rb") as file:
            end = os.fstat(file.fileno()).st_size
            raw = bytearray(end + _PADDING)
            end = file.readinto(memoryview(raw)[:end])
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "check the path") from None
    return raw, end


def _places(raw: bytearray, begin: int, end: int) -> tuple[NDArray[Any], tuple[str, ...]]:
    """Return the first byte of each record, and what is damaged. Each record says where the next one begins."""
    found, place, last = array("I" if end < 1 << 32 else "q"), begin, begin
    lengths = [1 + entry + size + time for entry, size, time in zip(_ENTRY, _SIZE, _TIME, strict=True)]
    add, size_bytes, entry_bytes = found.append, _SIZE, _ENTRY
    while place < end:
        bits = raw[place]
        if bits > 127:
            break
        add(place)
        last, size_at = place, place + 1 + entry_bytes[bits]
        if size_bytes[bits] == 1:
            place += lengths[bits] + raw[size_at]
        else:
            place += lengths[bits] + int.from_bytes(raw[size_at : size_at + size_bytes[bits]], "little")
    dtype = np.dtype(found.typecode)
    places = np.frombuffer(found, dtype) if found else np.empty(0, dtype)  # writable, as the array is
    if place > end:
        return places[:-1], (f"The file ends within a record: its last {end - last} bytes were left out.",)
    if place < end:
        return places, (
            f"The file is damaged at byte {place}: the {end - place} bytes from there were left out.",
        )
    return places, ()


def _narrowest(length: NDArray[np.uint8]) -> np.dtype[Any]:
    """Return the narrowest type that holds whole numbers of one to four bytes each."""
    return np.min_scalar_type((1 << 8 * int(length.max(initial=1))) - 1)


def _field(
    raw: bytearray, places: NDArray[Any], length: NDArray[np.uint8], dtype: np.dtype[Any]
) -> NDArray[Any]:
    """Return whole numbers of one to eight bytes, little end first."""
    masks = np.array([0, *((1 << 8 * count) - 1 for count in range(1, 9))], np.uint64)
    found = np.empty(len(places), dtype)
    words = _unaligned(raw, "<u8")
    for begin in range(0, len(places), _CHUNK):
        part = slice(begin, begin + _CHUNK)
        found[part] = words[places[part]] & masks[length[part]]
    return found


def _unaligned(raw: bytearray, dtype: str) -> NDArray[Any]:
    """Return every number of a type that a file could hold, one for each byte, without a copy."""
    width = np.dtype(dtype).itemsize
    return np.ndarray((len(raw) - width + 1,), dtype, buffer=raw, strides=(1,))
