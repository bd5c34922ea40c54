"""Messages as they lie in a file: bytes behind one another, read many at a time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_SPARSE = 8  # bytes of a buffer for one of the messages in it, from which on they lie far apart


class Columns(NamedTuple):
    """The numbers of some messages that hold the same fields.

    Attributes:
        rows: which messages they are, ascending, (n,).
        blocks: names of some fields, and their values, (n, names).
        stamps: time of each header, ns, (n,); None where they have none.
        long: names of arrays that are too long to be signals.
    """

    rows: NDArray[np.int64]
    blocks: list[tuple[tuple[str, ...], NDArray[np.float64]]]
    stamps: NDArray[np.int64] | None = None
    long: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Packed:
    """Messages in one buffer.

    Attributes:
        buffer: bytes, (bytes,).
        begins: place of each message, (n,).
        sizes: of each, in bytes, (n,).
    """

    buffer: NDArray[np.uint8]
    begins: NDArray[np.int64]
    sizes: NDArray[np.int64]

    @classmethod
    def of(cls, messages: Sequence[bytes]) -> "Packed":
        """Return messages that come one by one."""
        sizes = np.array([len(message) for message in messages], dtype=np.int64)
        return cls(np.frombuffer(b"".join(messages), dtype=np.uint8), np.cumsum(sizes) - sizes, sizes)

    @classmethod
    def of_arrow(cls, messages: Any) -> "Packed":
        """Return messages of an array of Arrow (binary, none of them null), as they lie in its memory."""
        _, places, content = messages.buffers()
        ends = np.frombuffer(places, dtype=np.int32)[messages.offset :][: len(messages) + 1].astype(np.int64)
        buffer = (
            np.frombuffer(content, dtype=np.uint8) if content is not None else np.empty(0, dtype=np.uint8)
        )
        return cls(buffer, ends[:-1], np.diff(ends))

    def __len__(self) -> int:
        return len(self.begins)

    def __getitem__(self, rows: NDArray[np.int64]) -> "Packed":
        return Packed(self.buffer, self.begins[rows], self.sizes[rows])

    def message(self, row: int) -> bytes:
        """Return one message."""
        begin = int(self.begins[row])
        return self.buffer[begin : begin + int(self.sizes[row])].tobytes()

    def texts(self) -> list[bytes]:
        """Return all messages; those that lie close together are cut out of one copy, which is faster."""
        if not len(self):
            return []
        ends = self.begins + self.sizes
        first, past = int(self.begins.min()), int(ends.max())
        if past - first > _SPARSE * int(self.sizes.sum()):
            return [self.message(row) for row in range(len(self))]
        content = self.buffer[first:past].tobytes()
        places = zip((self.begins - first).tolist(), (ends - first).tolist(), strict=True)
        return [content[begin:end] for begin, end in places]

    def alike(self) -> NDArray[np.uint8]:
        """Return messages of one size, (n, size)."""
        size = int(self.sizes[0])
        if size == 0:
            return np.zeros((len(self), 0), dtype=np.uint8)
        # At every byte of the buffer a message could begin.
        places = len(self.buffer) - size + 1
        everywhere = np.ndarray((places,), dtype=f"V{size}", buffer=self.buffer, strides=(1,))
        return everywhere[self.begins].view(np.uint8).reshape(-1, size)
