"""Numbers of messages in JSON, as MCAP files hold them."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from simgap.logs.readers.json_alike import LATEST, NAMES, columns_alike
from simgap.logs.readers.packed import Columns, Packed
from simgap.logs.readers.ros_steps import LONGEST

_NANOSECONDS = 1_000_000_000


def json_columns(messages: Packed, large: bool = False) -> Iterator[Columns]:
    """Yield the numbers of messages, those with the same names at once; what is no JSON object is left out.

    Arrays beside a list of names are named by it.

    Args:
        messages: in JSON.
        large: whether the file is so large that what has to be compiled first is faster.
    """
    together = columns_alike(messages, large)
    if together is not None:
        yield together
        return
    alike: dict[tuple[str, ...], list[tuple[int, list[float], int | None, set[str]]]] = {}
    for row in range(len(messages)):
        try:
            found, stamp, long = _numbers(messages.message(row))
        except ValueError:
            continue
        alike.setdefault(tuple(found), []).append((row, list(found.values()), stamp, long))
    for names, entries in alike.items():
        rows, values, stamps, longs = zip(*entries, strict=True)
        yield Columns(
            np.array(rows, dtype=np.int64),
            [(names, np.array(values, dtype=np.float64).reshape(len(rows), len(names)))],
            None if None in stamps else np.array(stamps, dtype=np.int64),
            frozenset().union(*longs),
        )


def _numbers(data: bytes) -> tuple[dict[str, float], int | None, set[str]]:
    """Return the numbers of a message, its stamp, and the names of long arrays.

    Raises:
        ValueError: when it is not JSON, or not an object.
    """
    long: set[str] = set()
    try:
        content = json.loads(data)
        if not isinstance(content, dict):
            raise ValueError("is no object")
        return dict(_flat(content, "", _names(content), long)), _stamp(content), long
    except RecursionError:
        raise ValueError("is nested too deeply") from None


def _flat(
    content: dict[str, Any], prefix: str, names: list[str], long: set[str]
) -> Iterator[tuple[str, float]]:
    for key, value in content.items():
        if not prefix and key in ("stamp", "header"):
            continue
        yield from _of(value, f"{prefix}{key}", names, long)


def _of(value: Any, name: str, names: list[str], long: set[str]) -> Iterator[tuple[str, float]]:
    if isinstance(value, bool | int | float):
        try:
            yield name, float(value)
        except OverflowError:
            raise ValueError("holds a number that is too large") from None
    elif isinstance(value, dict):
        yield from _flat(value, f"{name}/", _names(value) or names, long)
    elif isinstance(value, list):
        if len(value) > LONGEST:
            long.add(name)
            return
        marks = names if len(names) == len(value) else [str(place) for place in range(len(value))]
        for mark, element in zip(marks, value, strict=True):
            yield from _of(element, f"{name}[{mark}]", [], long)


def _names(content: dict[str, Any]) -> list[str]:
    for key in NAMES:
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
        if isinstance(seconds, int) and isinstance(nanoseconds, int) and abs(seconds) < LATEST:
            return seconds * _NANOSECONDS + nanoseconds % _NANOSECONDS
    if isinstance(stamp, int | float) and not isinstance(stamp, bool) and abs(stamp) < LATEST:
        return round(stamp * _NANOSECONDS)
    return None
