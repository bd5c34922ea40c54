"""Numbers of ROS messages.

Sources: wiki.ros.org/ROS/Technical Overview (ROS 1: little-endian, one number behind the other), and CDR of OMG
formal/04-03-12, chapter 15.3 (ROS 2: every number at a multiple of its size, behind four bytes that say the order).
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from simgap.logs.readers.ros_steps import LONGEST, Step, Steps

_NAMES = ("name", "names", "joint_name", "joint_names")  # of the elements of the arrays beside them
_ELEMENT_NAMES = ("child_frame_id", "name")  # of an element that is a message

Block = tuple[tuple[str, ...], tuple[int | float, ...]]
"""Names of some fields, and their values."""


@dataclass
class Decoded:
    """The numbers of one message.

    Attributes:
        blocks: names and values.
        stamp: of its header, ns; None where it has none.
        long: names of arrays that are too long to be signals.
    """

    blocks: list[Block] = field(default_factory=list)
    stamp: int | None = None
    long: set[str] = field(default_factory=set)


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
        self._formats: dict[tuple[str, str, int], struct.Struct] = {}
        self._labels: dict[tuple[str, Any], tuple[str, ...]] = {}
        self._steps = Steps(definitions, name, padded).of_type

    def numbers(self, data: bytes) -> Decoded:
        """Return the numbers of a message.

        Raises:
            ValueError: when the message is shorter than its type.
        """
        order, start = "<", 0
        if self._padded:
            if len(data) < 4 or data[0] != 0 or data[1] not in (0, 1):
                raise ValueError("is not plain CDR")
            order, start = ("<" if data[1] else ">"), 4
        cursor = _Cursor(memoryview(data)[start:], order, self._padded, self._formats, self._labels)
        try:
            cursor.run(self._steps, "")
        except struct.error:
            raise ValueError("is cut off") from None
        return cursor.found


class _Cursor:
    """A place in a message."""

    def __init__(
        self,
        data: memoryview,
        order: str,
        padded: bool,
        formats: dict[tuple[str, str, int], struct.Struct],
        labels: dict[tuple[str, Any], tuple[str, ...]],
    ) -> None:
        self.found = Decoded()
        self._data, self._order, self._padded = data, order, padded
        self._formats, self._labels = formats, labels
        self._place = 0
        self._names: tuple[str, ...] = ()
        self._element = ""

    def run(self, steps: list[Step], prefix: str) -> None:
        """Read what the steps describe."""
        for kind, *rest in steps:
            getattr(self, f"_{kind}")(prefix, *rest)

    def _numbers(self, prefix: str, names: tuple[str, ...], codes: str) -> None:
        values = self._unpack(codes)
        self.found.blocks.append((self._with_prefix(prefix, names), values))

    def _skip(self, prefix: str, size: int, count: int) -> None:
        self._align(size)
        self._place += size * count

    def _header(self, prefix: str, sequence: bool) -> None:
        if sequence:
            self._unpack("I")
        seconds, nanoseconds = self._unpack("iI")
        self.found.stamp = int(seconds) * 1_000_000_000 + int(nanoseconds)
        self._text()

    def _string(self, prefix: str, label: str) -> None:
        text = self._text()
        if prefix and label in _ELEMENT_NAMES and text:
            self._element = bytes(text).rstrip(b"\0").decode("utf-8", "replace")

    def _strings(self, prefix: str, label: str, count: int | None) -> None:
        texts = [self._text() for _ in range(self._count(4, count))]
        if label in _NAMES:
            self._names = tuple(bytes(text).rstrip(b"\0").decode("utf-8", "replace") for text in texts)

    def _array(self, prefix: str, name: str, code: str, count: int | None) -> None:
        size = struct.calcsize(f"<{code}")
        number = self._count(size, count)
        if number > LONGEST:
            self.found.long.add(prefix + name)
            self._align(size)
            self._place += size * number
        elif number:
            values = self._unpack(code * number)
            marks = self._names if len(self._names) == number else number
            self.found.blocks.append((self._marked(prefix + name, marks), values))

    def _messages(self, prefix: str, name: str, steps: list[Step], count: int | None) -> None:
        number = self._count(1, count)
        outer, blocks = self._element, self.found.blocks
        for place in range(number):
            self._element, self.found.blocks = "", []
            self.run(steps, "/")
            mark = self._element or str(place)
            if place < LONGEST:
                label = f"{prefix}{name}[{mark}]"
                blocks += [(self._with_prefix(label, names), values) for names, values in self.found.blocks]
        self._element, self.found.blocks = outer, blocks
        if number > LONGEST:
            self.found.long.add(prefix + name)

    def _text(self) -> memoryview:
        size = int(self._unpack("I")[0])
        text = self._data[self._place : self._place + size]
        if len(text) != size:
            raise ValueError("is cut off")
        self._place += size
        return text

    def _count(self, size: int, count: int | None) -> int:
        """Return how many elements follow, of so many bytes at least."""
        number = int(self._unpack("I")[0]) if count is None else count
        if number * size > len(self._data) - self._place:
            raise ValueError("is cut off")
        return number

    def _align(self, size: int) -> None:
        if self._padded:
            self._place += -self._place % size

    def _unpack(self, codes: str) -> tuple[int | float, ...]:
        key = self._order, codes, self._place % 8 if self._padded else 0
        if key not in self._formats:
            self._formats[key] = struct.Struct(self._order + "".join(self._spaced(codes, key[2])))
        layout = self._formats[key]
        values = layout.unpack_from(self._data, self._place)
        self._place += layout.size
        return values

    def _spaced(self, codes: str, place: int) -> list[str]:
        """Return the codes with the padding before each."""
        if not self._padded:
            return list(codes)
        parts = []
        for code in codes:
            size = struct.calcsize(f"<{code}")
            gap = -place % size
            parts.append("x" * gap + code)
            place += gap + size
        return parts

    def _with_prefix(self, prefix: str, names: tuple[str, ...]) -> tuple[str, ...]:
        if not prefix:
            return names
        key = prefix, names
        if key not in self._labels:
            self._labels[key] = tuple(prefix + name for name in names)
        return self._labels[key]

    def _marked(self, name: str, marks: tuple[str, ...] | int) -> tuple[str, ...]:
        key = name, marks
        if key not in self._labels:
            each = range(marks) if isinstance(marks, int) else marks
            self._labels[key] = tuple(f"{name}[{mark}]" for mark in each)
        return self._labels[key]
