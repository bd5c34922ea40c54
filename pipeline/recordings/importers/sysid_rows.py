"""The content of a SysId file by Arrow's parser, faster than Python's. Anything unusual is left to that."""

import io
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.json as arrow_json
from numpy.typing import NDArray

_LONGEST = 1 << 30  # bytes that are parsed at once
_AT_ONCE = 1 << 24  # bytes of which brackets are counted at once
_DEEPEST = 100  # lists in lists; Arrow builds one builder in another for each
_MOST_TEXTS = 64  # quotation marks: keys and few words; a bracket in a text may hide a list
_LEVELS = np.zeros(256, dtype=np.int8)
_LEVELS[ord("[")], _LEVELS[ord("]")] = 1, -1
_OTHERS = bytes(set(range(256)) - set(b"[]"))  # no brackets


def content_by_arrow(text: bytes) -> dict[str, Any] | None:
    """Return the content of a file, each list of lists as an array (rows, width); None where it is anything unusual.

    Args:
        text: one JSON object whose values are texts, numbers, or rows of equally many numbers.
    """
    if len(text) > _LONGEST or text.count(b"{") != 1 or text.count(b'"') > _MOST_TEXTS or _is_deep(text):
        return None
    reading = arrow_json.ReadOptions(use_threads=False, block_size=len(text) + 1)
    parsing = arrow_json.ParseOptions(newlines_in_values=True)
    try:
        table = arrow_json.read_json(io.BytesIO(text), read_options=reading, parse_options=parsing)
    except pa.ArrowException:
        return None
    if table.num_rows != 1:
        return None
    found = _content(table)
    del table
    pa.default_memory_pool().release_unused()
    return found


def _content(table: pa.Table) -> dict[str, Any] | None:
    """Return the one row of a table; None where a value is anything unusual."""
    found: dict[str, Any] = {}
    for name in table.column_names:
        column = table.column(name).combine_chunks()
        value = _rows(column) if pa.types.is_list(column.type) else column[0].as_py()
        if value is None or pa.types.is_temporal(column.type):  # a text, to Python's parser
            return None
        found[name] = value
    return found


def _is_deep(text: bytes) -> bool:
    """Whether lists stand in lists to more than a few levels."""
    level = lowest = highest = 0
    for begin in range(0, len(text), _AT_ONCE):
        brackets = text[begin : begin + _AT_ONCE].translate(None, _OTHERS)
        levels = level + np.cumsum(_LEVELS[np.frombuffer(brackets, np.uint8)], dtype=np.int64)
        if len(levels):
            level, lowest, highest = int(levels[-1]), min(lowest, levels.min()), max(highest, levels.max())
    return bool(highest - lowest > _DEEPEST)


def _rows(column: pa.ListArray) -> NDArray[np.float64] | None:
    """Return the one list of lists of a column as (rows, width); None where its rows differ or hold no numbers."""
    rows = column.flatten()
    if not pa.types.is_list(rows.type) or rows.null_count or not len(rows):
        return None
    widths, numbers = np.diff(rows.offsets.to_numpy()), rows.flatten()
    is_number = pa.types.is_floating(numbers.type) or pa.types.is_integer(numbers.type)
    if not is_number or numbers.null_count or (widths != widths[0]).any() or not widths[0]:
        return None
    return np.asarray(numbers.to_numpy().astype(float, copy=False).reshape(-1, widths[0]))
