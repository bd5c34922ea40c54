"""Types of ROS messages as steps by which to read one; nothing of a definition is ever executed."""

import struct
from collections.abc import Mapping
from typing import Any

LONGEST = 100  # elements of an array that are taken as signals; images, clouds and scans have more
CODES = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "octet": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""Type of a number to its letter in `struct`."""

_DEEPEST = 12  # levels of messages in messages; the deepest of the common ones (TF, trajectories) have 6
_MOST = 10_000  # fields of a type, of those in it too; the largest of the common ones have some hundred
_HEADER = "std_msgs/msg/Header"
_TIMES: dict[str, Any] = {
    f"builtin_interfaces/msg/{name}": ([], [("sec", (1, ("int32", 0))), ("nanosec", (1, ("uint32", 0)))])
    for name in ("Time", "Duration")
}
_BASE, _NAME, _ARRAY = 1, 2, 3  # as the parser of definitions numbers its nodes; 4 is a sequence

Step = tuple[Any, ...]
"""What to read, and its arguments; the name is that of a method of the reader of messages."""


class Steps:
    """The steps by which a message of a type is read.

    Attributes:
        of_type: the steps, numbers that follow one another in one.

    Args:
        definitions: type to (constants, fields), as `rosbags.typesys.get_types_from_msg` gives them.
        name: of the type.
        padded: whether numbers stand at multiples of their size: ROS 2.

    Raises:
        ValueError: when a type in it has no definition, or is too large.
    """

    def __init__(self, definitions: Mapping[str, Any], name: str, padded: bool) -> None:
        self._definitions = {**_TIMES, **definitions}
        self._padded = padded
        self._fields = 0
        self.of_type = self._compiled(name, "", 0)

    def _compiled(self, name: str, prefix: str, depth: int) -> list[Step]:
        if name not in self._definitions:
            raise ValueError(f"{name} has no definition")
        fields = self._definitions[name][1]
        self._fields += len(fields)
        if depth > _DEEPEST or self._fields > _MOST:
            raise ValueError(f"{name} is too large")
        if not fields and self._padded:
            return [("skip", 1, 1)]  # an empty structure holds one byte
        steps: list[Step] = []
        for label, description in fields:
            self._add(steps, prefix + label, label, description, depth)
        return steps

    def _add(self, steps: list[Step], name: str, label: str, description: Any, depth: int) -> None:
        node, rest = description
        if node == _BASE:
            _add_scalars(steps, (name,), label, rest[0])
        elif node == _NAME and rest == _HEADER and depth == 0 and label == "header":
            numbered = any(entry == "seq" for entry, _ in self._definitions.get(rest, ([], []))[1])
            steps.append(("header", numbered))
        elif node == _NAME:
            for step in self._compiled(rest, f"{name}/", depth + 1):
                if step[0] == "numbers":
                    _add_numbers(steps, step[1], step[2])
                else:
                    steps.append(step)
        else:
            self._add_list(steps, name, label, rest, rest[1] if node == _ARRAY else None, depth)

    def _add_list(
        self, steps: list[Step], name: str, label: str, rest: Any, count: int | None, depth: int
    ) -> None:
        """Append an array; its length is None where the message says it."""
        inner, kind = rest[0]
        if inner == _NAME:
            inside = self._compiled(kind, "", depth + 1)
            if not inside:
                raise ValueError(f"{kind} is empty")
            steps.append(("messages", name, inside, count))
        elif kind[0] == "string":
            steps.append(("strings", label, count))
        elif kind[0] not in CODES:
            raise ValueError(f"{kind[0]} cannot be read")
        elif count is not None and count <= LONGEST:
            _add_scalars(steps, tuple(f"{name}[{place}]" for place in range(count)), label, kind[0])
        else:
            steps.append(("array", name, CODES[kind[0]], count))


def _add_scalars(steps: list[Step], names: tuple[str, ...], label: str, kind: str) -> None:
    if kind == "string":
        steps.append(("string", label))
    elif kind not in CODES:
        raise ValueError(f"{kind} cannot be read")
    elif "covariance" in label:  # how sure a value is, not a quantity
        steps.append(("skip", struct.calcsize(f"<{CODES[kind]}"), len(names)))
    else:
        _add_numbers(steps, names, CODES[kind] * len(names))


def _add_numbers(steps: list[Step], names: tuple[str, ...], codes: str) -> None:
    """Append numbers, to those before where there are some: they are then read at once."""
    if steps and steps[-1][0] == "numbers":
        _, before, codes_before = steps.pop()
        names, codes = before + names, codes_before + codes
    steps.append(("numbers", names, codes))
