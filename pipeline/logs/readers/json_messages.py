"""Numbers of messages in JSON, as MCAP files hold them."""

import json
from collections.abc import Iterator
from typing import Any

from simgap.logs.readers.ros_messages import Decoded
from simgap.logs.readers.ros_steps import LONGEST

_NAMES = ("name", "names", "joint_name", "joint_names")  # of the elements of the arrays beside them
_NANOSECONDS = 1_000_000_000


def json_numbers(data: bytes) -> Decoded:
    """Return the numbers of a message; arrays beside a list of names are named by it.

    Raises:
        ValueError: when it is not JSON, or not an object.
    """
    try:
        content = json.loads(data)
        if not isinstance(content, dict):
            raise ValueError("is no object")
        found = Decoded(stamp=_stamp(content))
        pairs = dict(_flat(content, "", _names(content), found))
    except RecursionError:
        raise ValueError("is nested too deeply") from None
    found.blocks.append((tuple(pairs), tuple(pairs.values())))
    return found


def _flat(
    content: dict[str, Any], prefix: str, names: list[str], found: Decoded
) -> Iterator[tuple[str, float]]:
    for key, value in content.items():
        if not prefix and key in ("stamp", "header"):
            continue
        yield from _of(value, f"{prefix}{key}", names, found)


def _of(value: Any, name: str, names: list[str], found: Decoded) -> Iterator[tuple[str, float]]:
    if isinstance(value, bool | int | float):
        try:
            yield name, float(value)
        except OverflowError:
            raise ValueError("holds a number that is too large") from None
    elif isinstance(value, dict):
        yield from _flat(value, f"{name}/", _names(value) or names, found)
    elif isinstance(value, list):
        if len(value) > LONGEST:
            found.long.add(name)
            return
        marks = names if len(names) == len(value) else [str(place) for place in range(len(value))]
        for mark, element in zip(marks, value, strict=True):
            yield from _of(element, f"{name}[{mark}]", [], found)


def _names(content: dict[str, Any]) -> list[str]:
    for key in _NAMES:
        value = content.get(key)
        if isinstance(value, list) and value and all(isinstance(entry, str) for entry in value):
            return value
    return []


def _stamp(content: dict[str, Any]) -> int | None:
    """Return the time that a message bears, ns: a number of seconds, or seconds and nanoseconds."""
    header = content.get("header")
    stamp = content.get("stamp", header.get("stamp") if isinstance(header, dict) else None)
    if isinstance(stamp, dict):
        seconds = stamp.get("sec", stamp.get("secs"))
        nanoseconds = stamp.get("nanosec", stamp.get("nsec", stamp.get("nsecs", 0)))
        if isinstance(seconds, int) and isinstance(nanoseconds, int):
            return seconds * _NANOSECONDS + nanoseconds
    if (
        isinstance(stamp, int | float) and not isinstance(stamp, bool) and abs(stamp) < 1e10
    ):  # s until the year 2286
        return round(stamp * _NANOSECONDS)
    return None
