"""Records of MCAP files. Source: mcap.dev/spec."""

import struct
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.logs.readers.unpacking import unpacked

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 2, 3, 4, 5, 6, 15
"""Kinds of records."""

BEFORE_DATA = 22
"""Bytes of a message before its content: channel, number, time of recording, time of sending."""

_RECORD = struct.Struct("<BQ")
_CHUNK = struct.Struct("<QQQII")

Record = tuple[int, int, int]
"""Kind, and where the content begins and ends."""


def records(content: memoryview, place: int = 0) -> Iterator[Record]:
    """Yield the records of a file or of a chunk.

    Raises:
        ValueError: when a record is cut off, after those before it.
    """
    end = len(content)
    while place < end:
        try:
            kind, size = _RECORD.unpack_from(content, place)
        except struct.error:
            raise ValueError("a record is cut off") from None
        begin = place + _RECORD.size
        place = begin + size
        if place > end:
            raise ValueError("a record is cut off")
        yield kind, begin, place


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
    buffer: NDArray[np.uint8], begins: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the number of the channel and the time of recording, ns, of messages that begin at some places."""
    kind = np.dtype(
        {"names": ["channel", "time"], "formats": ["<u2", "<u8"], "offsets": [0, 6], "itemsize": 14}
    )
    everywhere = np.ndarray((len(buffer) - 13,), dtype=kind, buffer=buffer, strides=(1,))
    found = everywhere[begins]
    # A later time is none: the clocks of computers end in 2262.
    times = np.minimum(found["time"], np.uint64(np.iinfo(np.int64).max // 2))
    return found["channel"].astype(np.int64), times.astype(np.int64)
