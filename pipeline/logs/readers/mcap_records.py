"""Records of MCAP files. Source: mcap.dev/spec."""

import struct
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.logs.readers.unpacking import unpacked

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 2, 3, 4, 5, 6, 15
"""Kinds of records."""

BEFORE_DATA = 22
"""Bytes of a message before its data: channel, number, time of recording, time of sending."""

DATA = 31
"""Where the data of a message begin in its record."""

_RECORD = struct.Struct("<BQ")
_CHUNK = struct.Struct("<QQQII")

_LENGTH = _RECORD.size  # bytes of a record before its content

Record = tuple[int, int, int]
"""Kind, and where the content begins and ends."""


def record(content: memoryview, place: int) -> Record:
    """Return the record that begins at a place of a file or of a chunk.

    Raises:
        ValueError: when it is cut off.
    """
    begin = place + _LENGTH
    if begin > len(content):
        raise ValueError("a record is cut off")
    kind, size = _RECORD.unpack_from(content, place)
    if begin + size > len(content):
        raise ValueError("a record is cut off")
    return kind, begin, begin + size


def messages(content: memoryview, place: int, found: int, places: memoryview) -> tuple[int, int]:
    """Put down where messages begin that follow each other, behind those found before, while there is room for them.

    It can be compiled: `simgap.compiled`.

    Returns:
        How many are put down, and where the record behind them begins.
    """
    end, room = len(content), len(places)
    while place + 9 <= end and content[place] == 5 and found < room:
        size = 0
        for byte in range(8, 0, -1):
            size = min(256 * size + content[place + byte], end)  # compiled, a number must not outgrow 64 bits
        if size > end - place - 9:
            break
        places[found] = place
        found += 1
        place += 9 + size
    return found, place


def chunk_content(chunk: memoryview) -> memoryview:
    """Return the records of a chunk, unpacked.

    Raises:
        ValueError: when it is damaged, or too large.
    """
    try:
        _, _, size, _, letters = _CHUNK.unpack_from(chunk)
        place = _CHUNK.size + letters
        compression = bytes(chunk[_CHUNK.size : place]).decode()
        (packed_size,) = struct.unpack_from("<Q", chunk, place)
    except struct.error:
        raise ValueError("a chunk is cut off") from None
    packed = chunk[place + 8 : place + 8 + packed_size]
    if not compression:
        return packed
    return memoryview(unpacked(bytes(packed), compression, size))


def parsed(kind: int, content: memoryview) -> Any:
    """Return a schema or a channel."""
    from mcap.data_stream import ReadDataStream
    from mcap.records import Channel, Schema

    return (Schema if kind == SCHEMA else Channel).read(ReadDataStream(BytesIO(bytes(content))))


def heads(
    buffer: NDArray[np.uint8], places: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return size, number of the channel, and time of recording, ns, of the messages whose records begin at places.

    Raises:
        ValueError: when a message is shorter than its head.
    """
    sizes = _numbers(buffer, "<i8", places + 1) - BEFORE_DATA
    if (sizes < 0).any():
        raise ValueError("a message is cut off")
    channels = _numbers(buffer, "<u2", places + _LENGTH).astype(np.int64)
    # A later time is none: the clocks of computers end in 2262.
    latest = np.uint64(np.iinfo(np.int64).max // 2)
    times = np.minimum(_numbers(buffer, "<u8", places + _LENGTH + 6), latest)
    return sizes, channels, times.astype(np.int64)


def _numbers(buffer: NDArray[np.uint8], kind: str, places: NDArray[np.int64]) -> NDArray[Any]:
    """Return the numbers that begin at places."""
    width = np.dtype(kind).itemsize
    return np.ndarray((len(buffer) - width + 1,), kind, buffer=buffer, strides=(1,))[places]
