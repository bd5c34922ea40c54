"""Numbers of ROS messages.

Sources: wiki.ros.org/ROS/Technical Overview (ROS 1: little-endian, one number behind the other), and CDR of OMG
formal/04-03-12, chapter 15.3 (ROS 2: every number at a multiple of its size, behind four bytes that say the order).
"""

import struct
from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from simgap.logs.readers.message_layout import Layout, Numbers
from simgap.logs.readers.packed import Columns, Packed
from simgap.logs.readers.ros_steps import LONGEST, Step, Steps

_NAMES = ("name", "names", "joint_name", "joint_names")  # of the elements of the arrays beside them
_ELEMENT_NAMES = ("child_frame_id", "name")  # of an element that is a message
_LAYOUTS = 32  # of one size that are remembered; beyond them each message is read by itself
_SIZES = 1000  # for which layouts are remembered
_NUMPY = {"?": "u1", "b": "i1", "B": "u1", "h": "i2", "H": "u2", "i": "i4", "I": "u4", "q": "i8", "Q": "u8"}
_NUMPY |= {"f": "f4", "d": "f8"}
_BYTES = {code: struct.calcsize(f"<{code}") for code in _NUMPY}


class MessageType:
    """A type of messages, ready to read.

    Args:
        definitions: type to (constants, fields), as `rosbags.typesys.get_types_from_msg` gives them.
        name: of the type.
        padded: whether numbers stand at multiples of their size: ROS 2.

    Raises:
        ValueError: when a type in it has no definition, or is too large.
    """

    def __init__(self, definitions: Mapping[str, Any], name: str, padded: bool) -> None:
        self._padded = padded
        self._layouts: dict[int, list[Layout]] = {}
        self._steps = Steps(definitions, name, padded).of_type

    def columns(self, messages: Packed) -> Iterator[Columns]:
        """Yield the numbers of messages, those of one layout at once; a message shorter than its type is left out."""
        if len(messages) and (messages.sizes == messages.sizes[0]).all():
            yield from self._of_one_size(messages, np.arange(len(messages)), int(messages.sizes[0]))
            return
        sizes, kinds = np.unique(messages.sizes, return_inverse=True)
        for number, size in enumerate(sizes.tolist()):
            rows = np.flatnonzero(kinds == number)
            yield from self._of_one_size(messages, rows, size)

    def _of_one_size(self, messages: Packed, rows: NDArray[np.int64], size: int) -> Iterator[Columns]:
        if len(self._layouts) > _SIZES:
            self._layouts.clear()
        known = self._layouts.setdefault(size, [])
        content = messages[rows].alike()
        for layout in known:
            fitting = layout.fits(content)
            if fitting.all():
                yield layout.columns(content, rows)
                return
            if fitting.any():
                yield layout.columns(content[fitting], rows[fitting])
                content, rows = content[~fitting], rows[~fitting]
        while len(rows):
            layout_or_none = self._layout(messages.message(int(rows[0])))
            fitting = np.zeros(len(rows), dtype=bool)
            fitting[0] = True
            if layout_or_none is not None:
                if len(known) < _LAYOUTS:
                    known.append(layout_or_none)
                    fitting = layout_or_none.fits(content)
                yield layout_or_none.columns(content[fitting], rows[fitting])
            content, rows = content[~fitting], rows[~fitting]

    def _layout(self, message: bytes) -> Layout | None:
        """Return the layout of a message; None where it is shorter than its type."""
        order: Literal["<", ">"] = "<"
        start = 0
        if self._padded:
            if len(message) < 4 or message[0] != 0 or message[1] not in (0, 1):
                return None
            order, start = ("<" if message[1] else ">"), 4
        cursor = _Cursor(message, start, order, self._padded)
        try:
            cursor.run(self._steps, "")
        except (struct.error, _CutOffError):
            return None
        return cursor.layout() if cursor.place <= len(message) else None


class _CutOffError(ValueError):
    """A message is shorter than it says."""


class _Cursor:
    """A place in a message, and what was found before it."""

    def __init__(self, message: bytes, start: int, order: Literal["<", ">"], padded: bool) -> None:
        self.place = start
        self._message, self._start, self._order, self._padded = message, start, order, padded
        self._numbers_found: list[Numbers] = []
        self._guards = [(0, start)]  # begin and end
        self._stamp: int | None = None
        self._long: set[str] = set()
        self._names: tuple[str, ...] = ()
        self._element = ""

    def layout(self) -> Layout:
        """Return what was found."""
        return Layout(
            self._message,
            tuple(self._numbers_found),
            np.concatenate([np.arange(begin, end) for begin, end in self._guards]),
            self._stamp,
            self._order,
            frozenset(self._long),
        )

    def run(self, steps: list[Step], prefix: str) -> None:
        """Go through what the steps describe."""
        for kind, *rest in steps:
            getattr(self, f"_{kind}")(prefix, *rest)

    def _numbers(self, prefix: str, names: tuple[str, ...], codes: str) -> None:
        first = 0
        for code, group in groupby(codes):
            past = first + sum(1 for _ in group)
            self._add([prefix + name for name in names[first:past]], code)
            first = past

    def _add(self, names: list[str], code: str) -> None:
        self._align(_BYTES[code])
        self._numbers_found.append(Numbers(tuple(names), self.place, _NUMPY[code]))
        self.place += _BYTES[code] * len(names)

    def _skip(self, prefix: str, size: int, count: int) -> None:
        self._align(size)
        self.place += size * count

    def _header(self, prefix: str, sequence: bool) -> None:
        self._align(4)
        self._stamp = self.place + (4 if sequence else 0)
        self.place = self._stamp + 8
        self._text()

    def _string(self, prefix: str, label: str) -> None:
        named = bool(prefix) and label in _ELEMENT_NAMES
        text = self._text(guarded=named)
        if named and text:
            self._element = text

    def _strings(self, prefix: str, label: str, count: int | None) -> None:
        named = label in _NAMES
        texts = [self._text(guarded=named) for _ in range(self._count(4, count))]
        if named:
            self._names = tuple(texts)

    def _array(self, prefix: str, name: str, code: str, count: int | None) -> None:
        number = self._count(_BYTES[code], count)
        if number > LONGEST:
            self._long.add(prefix + name)
            self._skip(prefix, _BYTES[code], number)
        elif number:
            marks = self._names if len(self._names) == number else range(number)
            self._add([f"{prefix}{name}[{mark}]" for mark in marks], code)

    def _messages(self, prefix: str, name: str, steps: list[Step], count: int | None) -> None:
        number = self._count(1, count)
        outer, found = self._element, self._numbers_found
        for place in range(number):
            self._element, self._numbers_found = "", []
            self.run(steps, "/")
            label = f"{prefix}{name}[{self._element or place}]"
            if place < LONGEST:
                found += [
                    part._replace(names=tuple(label + inner for inner in part.names))
                    for part in self._numbers_found
                ]
        self._element, self._numbers_found = outer, found
        if number > LONGEST:
            self._long.add(prefix + name)

    def _text(self, guarded: bool = False) -> str:
        """Go behind a text; it is returned where it is a name."""
        size = self._word()
        begin, self.place = self.place, self.place + size
        if self.place > len(self._message):
            raise _CutOffError
        if not guarded:
            return ""
        self._guards.append((begin, self.place))
        return self._message[begin : self.place].rstrip(b"\0").decode("utf-8", "replace")

    def _count(self, size: int, count: int | None) -> int:
        """Return how many elements follow, of so many bytes at least."""
        number = self._word() if count is None else count
        if number * size > len(self._message) - self.place:
            raise _CutOffError
        return number

    def _word(self) -> int:
        """Return a length."""
        self._align(4)
        (length,) = struct.unpack_from(f"{self._order}I", self._message, self.place)
        self._guards.append((self.place, self.place + 4))
        self.place += 4
        return int(length)

    def _align(self, size: int) -> None:
        if self._padded:
            self.place += -(self.place - self._start) % size
