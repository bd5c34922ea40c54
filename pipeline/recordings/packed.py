"""Files that may be packed by gzip, read without unpacking more than a table can hold."""

import gzip
import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from simgap.errors import InputError

_GZIP = b"\x1f\x8b"
_SMALL = 1 << 26  # bytes of unpacked text that fit anywhere
_DENSEST = 100  # times that numbers as text shrink at most; deflate alone reaches 1032 on one repeated byte


@contextmanager
def opened(path: Path, where: str) -> Iterator[io.BufferedIOBase]:
    """Open a file for reading, and unpack it where it was packed by gzip.

    Args:
        path: of the file.
        where: what to name in an error.

    Raises:
        InputError: while reading, when it unpacks to more than any table.
    """
    with path.open("rb") as raw:
        packed = raw.read(len(_GZIP)) == _GZIP
        raw.seek(0)
        if not packed:
            yield raw
            return
        limit = max(_SMALL, _DENSEST * path.stat().st_size)
        with gzip.GzipFile(fileobj=raw) as unpacked:
            yield _Limited(unpacked, limit, where)


class _Limited(io.BufferedIOBase):
    """A stream that ends in an error behind so many bytes."""

    def __init__(self, stream: io.BufferedIOBase, limit: int, where: str) -> None:
        self._stream, self._left, self._where = stream, limit, where

    def readable(self) -> bool:
        return True

    def read(self, size: int | None = -1, /) -> bytes:
        content = self._stream.read(self._left + 1 if size is None or size < 0 else size)
        self._left -= len(content)
        if self._left < 0:
            raise InputError("unpacks to more than any table", self._where, "unpack it, and look what it is")
        return content
