"""Messages of ROS 1 bags, many at a time. Source: wiki.ros.org/Bags/Format/2.0.

`rosbags` reads what is rare: the connections, and where the chunks are. The index of a chunk, twelve bytes a message,
says when each of its messages came and where it is; it is read at once here, as are the messages.
"""

from collections.abc import Iterator
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1 import Reader
from rosbags.rosbag1.reader import Header, RecordType, decompressors, read_bytes, read_uint32

from simgap.logs.readers.packed import Packed
from simgap.logs.readers.unpacking import unpacked

_ENTRY = np.dtype([("seconds", "<u4"), ("nanoseconds", "<u4"), ("offset", "<u4")])
_MESSAGE = 2  # kind of a record
_MOST_FIELDS = 8  # of the header of a record
_MOST_BEFORE = 64  # connections between the place that an index gives and its message
_KEPT = 4  # chunks; those of one recorder overlap in time with their neighbours only


class Stretch(NamedTuple):
    """Messages that follow each other in time, and lie in one chunk.

    Attributes:
        connections: id of the connection of each, (n,).
        times: at which they were recorded, ns, (n,).
        messages: packed.
    """

    connections: NDArray[np.int64]
    times: NDArray[np.int64]
    messages: Packed


class IndexedBag(Reader):
    """A bag whose index is kept as arrays."""

    def __init__(self, path: Path) -> None:
        """Prepare to open a bag."""
        super().__init__(path)
        self._parts: list[tuple[int, int, NDArray[Any]]] = []

    def read_index_data(self, pos: int, indexes: Any) -> None:
        """Read the index of one connection in one chunk; see `Reader`, of which it takes the place."""
        assert self.bio
        header = Header.read(self.bio, RecordType.IDXDATA)
        entries = np.frombuffer(read_bytes(self.bio, read_uint32(self.bio)), dtype=_ENTRY)
        self._parts.append((pos, header.get_uint32("conn"), entries))

    def recorded(self) -> set[int]:
        """Return the ids of the connections that have messages."""
        return {connection for _, connection, entries in self._parts if len(entries)}

    def stretches(self) -> Iterator[Stretch]:
        """Yield the messages by time.

        Raises:
            ValueError, IndexError, OSError: when a chunk is damaged, after what was before it.
        """
        if not self._parts:
            return
        lengths = [len(entries) for _, _, entries in self._parts]
        entries = np.concatenate([entries for _, _, entries in self._parts])
        chunks = np.repeat([chunk for chunk, _, _ in self._parts], lengths)
        connections = np.repeat([connection for _, connection, _ in self._parts], lengths)
        times = entries["seconds"].astype(np.int64) * 1_000_000_000 + entries["nanoseconds"]
        order = np.argsort(times, kind="stable")
        content = lru_cache(_KEPT)(self._content)
        for rows in np.split(order, np.flatnonzero(np.diff(chunks[order])) + 1):
            buffer = content(int(chunks[rows[0]])) if len(rows) else np.empty(0, np.uint8)
            messages = _messages(buffer, entries["offset"][rows].astype(np.int64))
            yield Stretch(connections[rows], times[rows], messages)

    def _content(self, place: int) -> NDArray[np.uint8]:
        """Return the records of a chunk, never more of them than is sensible."""
        assert self.bio
        chunk = self.chunks[place]
        names = {function: name for name, function in decompressors.items()}
        unpack = partial(unpacked, compression=names[chunk.decompressor])
        self.bio.seek(chunk.datapos)
        return np.frombuffer(unpack(read_bytes(self.bio, chunk.datasize)), dtype=np.uint8)


def _messages(buffer: NDArray[np.uint8], places: NDArray[np.int64]) -> Packed:
    """Return the messages whose records begin at some places, or behind the connections there."""
    if len(buffer) < 8:
        raise ValueError("a chunk is cut off")
    words = np.ndarray((len(buffer) - 3,), dtype="<u4", buffer=buffer, strides=(1,))
    for _ in range(_MOST_BEFORE):
        data = places + 4 + words[places]
        sizes = words[data].astype(np.int64)
        other = _kinds(buffer, words, places + 4, data) != _MESSAGE
        if not other.any():
            break
        places = np.where(other, data + 4 + sizes, places)
    else:
        raise ValueError("where the index says a message is, there is none")
    if (data + 4 + sizes > len(buffer)).any():
        raise ValueError("a message is cut off")
    return Packed(buffer, data + 4, sizes)


def _kinds(
    buffer: NDArray[np.uint8], words: NDArray[np.uint32], begins: NDArray[np.int64], ends: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return what each record is, as the field `op` of its header says; zero where none does.

    Args:
        buffer: of the chunk.
        words: number that begins at each byte of it.
        begins: first byte of each header.
        ends: byte behind it.
    """
    kinds = np.zeros(len(begins), dtype=np.int64)
    for _ in range(_MOST_FIELDS):
        inside = np.flatnonzero(begins < ends)
        if not len(inside):
            break
        field = begins[inside]
        named = (words[field + 3] >> 8 == int.from_bytes(b"op=", "little")) & (words[field] == 4)
        kinds[inside[named]] = buffer[field[named] + 7]
        begins = begins.copy()
        begins[inside] = field + 4 + words[field]
    return kinds
