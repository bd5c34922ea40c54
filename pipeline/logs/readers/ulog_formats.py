"""What a ULog may define: formats that contain themselves, or more than a record can hold, are left out.

A few bytes of a damaged or ill-meant file can define a format of any size.
"""

import struct
from collections.abc import Iterator

_MOST_FIELDS = (
    4096  # of a topic; the largest of PX4 have a few hundred, counted with all elements of their arrays
)
_TOO_MANY = _MOST_FIELDS + 1
_DEEPEST = 8  # formats in formats; those of PX4 are two deep

_Formats = dict[str, list[tuple[str, int]]]


def within_bounds(messages: list[tuple[int, bytes]], numbers: set[int]) -> Iterator[tuple[int, bytes]]:
    """Yield the messages without formats that are too large, and without subscriptions that have no records.

    Args:
        messages: type and bytes, with the three of the header.
        numbers: message ids that have records.
    """
    formats = dict(_format(message) for message in _definitions(messages))
    counted: dict[str, int] = {}
    subscribed: set[int] = set()
    defining = True
    for kind, message in messages:
        defining = defining and chr(kind) not in "ACL"
        if kind == ord("F") and not (defining and _fits(_format(message)[0], formats, counted)):
            continue
        if kind == ord("A"):
            if len(message) < 7 or not _fits(_text(message[6:]), formats, counted):
                continue
            (number,) = struct.unpack_from("<H", message, 4)
            if number not in numbers or number in subscribed:
                continue
            subscribed.add(number)
        yield kind, message


def _definitions(messages: list[tuple[int, bytes]]) -> Iterator[bytes]:
    """Yield the formats, which end where the first subscription or text of the log is."""
    for kind, message in messages:
        if chr(kind) in "ACL":
            return
        if kind == ord("F"):
            yield message


def _format(message: bytes) -> tuple[str, list[tuple[str, int]]]:
    """Return the name of a format, and the types and numbers of its fields."""
    name, _, rest = _text(message[3:]).partition(":")
    fields = rest.partition(":")[0].split(";")
    return name, [_field(entry) for entry in fields if entry]


def _field(entry: str) -> tuple[str, int]:
    kind, bracket, rest = entry.partition(" ")[0].partition("[")
    number = rest.partition("]")[0]
    if not bracket:
        return kind, 1
    return kind, int(number) if number.isdecimal() and len(number) < 6 else _TOO_MANY


def _text(raw: bytes) -> str:
    return raw.decode("utf-8", "ignore")


def _fits(name: str, formats: _Formats, counted: dict[str, int]) -> bool:
    return name in formats and _count(name, formats, counted, 0) <= _MOST_FIELDS


def _count(name: str, formats: _Formats, counted: dict[str, int], depth: int) -> int:
    """Return the number of fields of a format, with those of the formats in it; too many where it has no end."""
    if depth > _DEEPEST:
        return _TOO_MANY
    if name not in counted:
        counted[name] = _TOO_MANY  # what it is if it contains itself
        total = 0
        for kind, number in formats[name]:
            inner = _count(kind, formats, counted, depth + 1) if kind in formats else 1
            total = min(total + number * inner, _TOO_MANY)
        counted[name] = total
    return counted[name]
