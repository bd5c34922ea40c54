"""The content of a large SysId file whose rows are the same but for their numbers; anything else is for a parser."""

import json
import mmap
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap import compiled
from simgap.recordings.alike_texts import between_numbers, numbers_alike

_MOST_TEXTS = 64  # quotation marks: keys and few words
_AT_ONCE = 1 << 20  # bytes of which brackets are looked for at once
_TABLE = re.compile(rb'"\s*:\s*\[\s*(?=\[)')  # from the end of a key to the first row
_ROW = re.compile(rb"\[[^\[\]]*\]")
_SPACE = b" \t\r\n"


def content_of_rows(path: Path) -> dict[str, Any] | None:
    """Return the content of a file, each list of rows as an array (rows, width); None where it is anything unusual.

    Args:
        path: of one JSON object whose values are texts, numbers, or rows of equally many numbers.
    """
    if path.stat().st_size < compiled.LARGE:
        return None
    with path.open("rb") as file:
        return _content(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))


def _content(text: mmap.mmap) -> dict[str, Any] | None:
    tables: list[NDArray[np.float64]] = []
    rest: list[bytes] = []
    end = 0
    for begin, past in _tables(text):
        rows = _numbers(text, begin, past)
        if rows is None:
            return None
        rest.append(text[end:begin] + b"%d" % len(tables))  # a list of one number stands for the rows
        tables.append(rows)
        end = past
    return _joined(b"".join(rest) + text[end:], tables) if tables else None


def _tables(text: mmap.mmap) -> Iterator[tuple[int, int]]:
    """Yield where the rows of each table begin and end."""
    place = text.find(b'"')
    for _ in range(_MOST_TEXTS):
        following = text.find(b'"', place + 1)
        opened = _TABLE.match(text, place)
        past = following if following >= 0 else len(text)
        if opened:
            begin = opened.end()
            closed = text.rfind(b"]", begin, past)
            yield begin, 1 + text.rfind(b"]", begin, max(closed, begin))
        if following < 0:
            return
        place = following


def _numbers(text: mmap.mmap, begin: int, past: int) -> NDArray[np.float64] | None:
    """Return rows, (rows, width), that lie from one place to another; None where they are not alike."""
    first = _ROW.match(text, begin, past)
    between = between_numbers(first.group()) if first else []
    # With a number between all of these, nothing but numbers is in a row.
    bare = b"[" + b"," * (len(between) - 2) + b"]"
    if first is None or len(between) < 2 or b"".join(between).translate(None, _SPACE) != bare:
        return None
    begins = _opened(text, begin, past)
    comma = text[first.end() : int(begins[1])] if len(begins) > 1 else b""
    if comma.translate(None, _SPACE) != b",":
        return None
    before = begins[1:] - len(comma)  # where the rows but the last one end
    buffer = np.frombuffer(text, dtype=np.uint8)
    sizes = np.append(before, past) - begins
    if sizes.min() < 0 or any((buffer[before + place] != byte).any() for place, byte in enumerate(comma)):
        return None
    return numbers_alike(buffer, begins, sizes, between)


def _opened(text: mmap.mmap, begin: int, past: int) -> NDArray[np.int64]:
    """Return where lists begin."""
    buffer = np.frombuffer(text, dtype=np.uint8)[:past]
    parts = [(place, buffer[place : place + _AT_ONCE]) for place in range(begin, past, _AT_ONCE)]
    return np.concatenate([place + np.flatnonzero(part == ord("[")) for place, part in parts])


def _joined(rest: bytes, tables: list[NDArray[np.float64]]) -> dict[str, Any] | None:
    """Return the content of what is not rows, with the rows; None where the number of a table is not in its place."""
    try:
        content = json.loads(rest.decode())
    except (ValueError, RecursionError):
        return None
    if not isinstance(content, dict):
        return None
    lists = {name: value for name, value in content.items() if isinstance(value, list)}
    if list(lists.values()) != [[number] for number in range(len(tables))]:
        return None
    return content | dict(zip(lists, tables, strict=True))
