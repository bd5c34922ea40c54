"""Messages in JSON that are all alike, read at once. Anything unusual is left to a slower reader."""

import io
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.json as arrow_json
from numpy.typing import NDArray

from simgap.logs.readers.json_pattern import columns_of_pattern, numbered
from simgap.logs.readers.packed import Columns, Packed
from simgap.logs.readers.ros_steps import LONGEST
from simgap.recordings.alike_texts import between_numbers

NAMES = ("name", "names", "joint_name", "joint_names")  # of the elements of the arrays beside them
LATEST = 9e9  # s; the year 2255, of which the nanoseconds fit a whole number of 64 bits
_NANOSECONDS = 1_000_000_000
_DEEPEST = 1000  # lists and objects of a message; deeper ones than a parser can descend to have more
_LONGEST = 1 << 28  # bytes that are parsed at once


class _UnlikeError(ValueError):
    """The messages are not alike."""


def columns_alike(messages: Packed, large: bool = False) -> Columns | None:
    """Return the numbers of messages with the same names in the same order; None where some differ, or are damaged.

    Args:
        messages: in JSON.
        large: whether the file is so large that what has to be compiled first is faster.
    """
    found = None
    if large and len(messages):
        between = tuple(between_numbers(messages.message(0)))
        example = _example(between)
        found = columns_of_pattern(messages, between, example) if example is not None else None
    return _parsed(messages) if found is None else found


@lru_cache
def _example(between: tuple[bytes, ...]) -> Columns | None:
    """Return what is found in a message with so many numbers."""
    return _parsed(Packed.of([numbered(between)]))


def _parsed(messages: Packed) -> Columns | None:
    """Return the numbers of messages by Arrow's parser; None where some differ, or are damaged."""
    longest = np.flatnonzero(messages.sizes > _DEEPEST)  # only these can be that deep
    if messages.sizes.sum() > _LONGEST or any(_is_deep(messages.message(row)) for row in longest.tolist()):
        return None
    joined = b"\n".join(messages.texts())
    if joined.count(b"\n") != len(messages) - 1:  # one has lines
        return None
    options = arrow_json.ReadOptions(use_threads=False, block_size=len(joined) + 1)
    try:
        table = arrow_json.read_json(io.BytesIO(joined), read_options=options)
        if table.num_rows != len(messages):
            return None
        content = {name: table.column(name).combine_chunks() for name in table.column_names}
        long: set[str] = set()
        found = dict(_flat(content, "", _names(content), long))
        values = np.stack(list(found.values()), axis=1) if found else np.empty((len(messages), 0))
        rows = np.arange(len(messages))
        return Columns(rows, [(tuple(found), values)], _stamps(content), frozenset(long))
    except (pa.ArrowException, _UnlikeError):
        return None


def _is_deep(text: bytes) -> bool:
    """Whether lists and objects may be nested too deeply."""
    return text.count(b"[") + text.count(b"{") > _DEEPEST


def _flat(
    content: dict[str, pa.Array], prefix: str, names: list[str], long: set[str]
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    for key, values in content.items():
        if prefix or key not in ("stamp", "header"):
            yield from _of(values, f"{prefix}{key}", names, long)


def _of(
    values: pa.Array, name: str, names: list[str], long: set[str]
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    if values.null_count or pa.types.is_null(values.type):
        raise _UnlikeError
    if pa.types.is_struct(values.type):
        content = _parts(values)
        yield from _flat(content, f"{name}/", _names(content) or names, long)
    elif pa.types.is_list(values.type):
        width = _width(values)
        if width > LONGEST:
            long.add(name)
            return
        marks = names if len(names) == width else [str(place) for place in range(width)]
        inner = values.flatten()
        for place, mark in enumerate(marks):
            yield from _of(
                inner.take(pa.array(np.arange(place, len(inner), width))), f"{name}[{mark}]", [], long
            )
    elif not (pa.types.is_string(values.type) or pa.types.is_temporal(values.type)):
        yield name, values.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)


def _parts(values: pa.StructArray) -> dict[str, pa.Array]:
    return dict(zip([field.name for field in values.type], values.flatten(), strict=True))


def _width(values: pa.ListArray) -> int:
    """Return how many elements each list has."""
    offsets = values.offsets.to_numpy()
    widths = np.diff(offsets)
    if not len(widths) or (widths != widths[0]).any() or widths[0] == 0:
        raise _UnlikeError
    return int(widths[0])


def _names(content: dict[str, pa.Array]) -> list[str]:
    """Return the names of the elements of arrays, which have to be the same in all messages."""
    for key in NAMES:
        values = content.get(key)
        if (
            values is None
            or not pa.types.is_list(values.type)
            or not pa.types.is_string(values.type.value_type)
        ):
            continue
        if values.null_count or values.flatten().null_count:
            raise _UnlikeError
        width = _width(values)
        encoded = values.flatten().dictionary_encode()
        codes = encoded.indices.to_numpy().reshape(-1, width)
        if (codes != codes[0]).any():
            raise _UnlikeError
        return [encoded.dictionary[int(code)].as_py() for code in codes[0]]
    return []


def _stamps(content: dict[str, pa.Array]) -> NDArray[np.int64] | None:
    """Return the times that messages bear, ns; None where they bear none."""
    header = content.get("header")
    inside = _parts(header) if header is not None and pa.types.is_struct(header.type) else {}
    stamp = content.get("stamp", inside.get("stamp"))
    if stamp is None or pa.types.is_string(stamp.type) or pa.types.is_temporal(stamp.type):
        return None
    if stamp.null_count:
        raise _UnlikeError
    if pa.types.is_struct(stamp.type):
        parts = _parts(stamp)
        seconds = parts.get("sec", parts.get("secs"))
        rest = parts.get("nanosec", parts.get("nsec", parts.get("nsecs")))
        whole = _whole(seconds)
        if not (np.abs(whole) < LATEST).all():
            raise _UnlikeError
        return _NANOSECONDS * whole + _whole(rest) % _NANOSECONDS
    if not (pa.types.is_integer(stamp.type) or pa.types.is_floating(stamp.type)):
        return None
    numbers = stamp.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    if not (np.abs(numbers) < LATEST).all():
        raise _UnlikeError
    return np.rint(numbers * _NANOSECONDS).astype(np.int64)


def _whole(values: Any) -> NDArray[np.int64]:
    if values is None or values.null_count or not pa.types.is_integer(values.type):
        raise _UnlikeError
    return np.asarray(values.to_numpy(zero_copy_only=False), dtype=np.int64)
