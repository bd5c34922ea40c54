"""Where the numbers of a message lie: what is found of one message holds for all that say the same between them."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from simgap.logs.readers.packed import Columns

_SECOND = 1_000_000_000  # ns


class Numbers(NamedTuple):
    """Numbers of one type, one behind the other.

    Attributes:
        names: of the fields.
        place: of the first one, in bytes.
        code: of the type, as numpy writes it without the order of bytes.
    """

    names: tuple[str, ...]
    place: int
    code: str


@dataclass(frozen=True)
class Layout:
    """Places in a message.

    Attributes:
        message: from which it was found.
        numbers: that are read.
        guards: places of the bytes that say where numbers are and what they are called: lengths and names.
        stamp: place of the header's seconds and nanoseconds; None without a header.
        order: of bytes, `<` or `>`.
        long: names of arrays that are too long to be signals.
    """

    message: bytes
    numbers: tuple[Numbers, ...]
    guards: NDArray[np.int64]
    stamp: int | None
    order: Literal["<", ">"]
    long: frozenset[str]

    def fits(self, messages: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Return which messages of the same size, (n, size), have the same layout, (n,)."""
        wanted = np.frombuffer(self.message, dtype=np.uint8)[self.guards]
        return (messages[:, self.guards] == wanted).all(axis=1)

    def columns(self, messages: NDArray[np.uint8], rows: NDArray[np.int64]) -> Columns:
        """Return the numbers of messages that fit.

        Args:
            messages: (n, size).
            rows: which messages they are, (n,).
        """
        blocks = [
            (part.names, self._read(messages, part.place, part.code, len(part.names)))
            for part in self.numbers
        ]
        stamps = None
        if self.stamp is not None:
            seconds = self._read(messages, self.stamp, "i4", 1)[:, 0].astype(np.int64)
            stamps = seconds * _SECOND + self._read(messages, self.stamp + 4, "u4", 1)[:, 0].astype(np.int64)
        return Columns(rows, blocks, stamps, self.long)

    def _read(self, messages: NDArray[np.uint8], place: int, code: str, count: int) -> NDArray[np.float64]:
        kind = np.dtype(code).newbyteorder(self.order)
        strides = messages.strides[0], kind.itemsize
        return np.ndarray((len(messages), count), kind, messages, place, strides).astype(np.float64)
