"""Tables as JSON: a list of records, a dictionary of lists, one record a line, or a list of runs of lists."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.logs.log import Log
from simgap.logs.tabular import log_of_table

_LARGEST = 1 << 28  # bytes; Python's objects take some ten times the text
_WIDEST = 64  # numbers in one place of a record
_DEEPEST = 4  # levels of a record that become parts of a name


def read(path: Path) -> Log:
    """Read a table as JSON.

    Numbers and words beside the table are facts. Nested records become names with dots, lists name[0], name[1].

    Raises:
        InputError: when it is no JSON, or holds no table.
    """
    content = _content(path)
    found = _table(content)
    if found is None:
        raise InputError("holds no table", str(path), "write a list of records, or a dictionary of lists")
    columns, facts = found
    rows = _rows(columns)
    kept = {name: values for name, values in columns.items() if len(values) == rows}
    left_out = [name for name in columns if name not in kept]
    said = (f"Left out, since they have another length: {', '.join(left_out[:6])}.",) if left_out else ()
    frame = pd.DataFrame({name: _column(values) for name, values in kept.items()})
    return log_of_table(frame, path, "JSON table", facts=facts, remarks=said)


def _content(path: Path) -> Any:
    size = path.stat().st_size
    if size > _LARGEST:
        raise InputError(f"has {size >> 20} MiB, too much for JSON", str(path), "write it as CSV or Parquet")
    try:
        text = path.read_bytes().decode("utf-8-sig")
        if path.suffix.lower() in (".jsonl", ".ndjson"):
            return [json.loads(line) for line in text.splitlines() if line.strip()]
        return json.loads(text)
    except (ValueError, RecursionError):
        raise InputError("is not JSON", str(path), "write it again; it may be cut off") from None


def _table(content: Any) -> tuple[dict[str, Sequence[Any]], dict[str, str]] | None:
    """Return columns and facts of the largest table in a document."""
    if isinstance(content, list):
        columns = _of_runs(content) or _of_records(content)
        return (columns, {}) if columns else None
    if not isinstance(content, Mapping):
        return None
    facts = {
        name: str(value) for name, value in _flat(content) if isinstance(value, str | int | float | bool)
    }
    lists = {
        str(k): v for k, v in content.items() if isinstance(v, list) and v and not isinstance(v[0], Mapping)
    }
    tables = [
        found for value in content.values() if isinstance(value, list | Mapping) and (found := _table(value))
    ]
    best = max(tables, key=lambda found: _rows(found[0]), default=None)
    if lists and _rows(lists) >= (_rows(best[0]) if best else 2):
        return _flat_lists(lists), facts
    return (best[0], facts | best[1]) if best else None


def _of_runs(content: list[Any]) -> dict[str, Sequence[Any]] | None:
    """Return a list of dictionaries of lists as one table with a column `run`; None where it is none.

    Lists that are as short in every entry are the joints of a record.
    """
    lengths = {
        len(v)
        for entry in content
        if isinstance(entry, Mapping)
        for v in entry.values()
        if isinstance(v, list)
    }
    if len(lengths) == 1 and max(lengths) <= _WIDEST:
        return None
    columns: dict[str, list[Any]] = {"run": []}
    for number, entry in enumerate(content, 1):
        if not isinstance(entry, Mapping):
            return None
        lists = {
            str(k): v for k, v in entry.items() if isinstance(v, list) and v and not isinstance(v[0], Mapping)
        }
        rows = _rows(lists)
        if rows < 2:
            return None
        before = len(columns["run"])
        columns["run"] += [f"{number}"] * rows
        for name, values in lists.items():
            if len(values) == rows:
                columns.setdefault(name, [None] * before).extend(values)
        for values in columns.values():
            values += [None] * (before + rows - len(values))
    return columns if len(columns) > 1 else None  # type: ignore[return-value]


def _of_records(content: list[Any]) -> dict[str, Sequence[Any]] | None:
    records = [dict(_flat(entry)) for entry in content if isinstance(entry, Mapping)]
    if len(records) < 2:
        return None
    names = dict.fromkeys(name for record in records for name in record)
    return {name: [record.get(name) for record in records] for name in names}


def _flat(entry: Mapping[str, Any], before: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    for key, value in entry.items():
        name = f"{before}{key}"
        if isinstance(value, Mapping) and depth < _DEEPEST:
            yield from _flat(value, f"{name}.", depth + 1)
        elif isinstance(value, list) and len(value) <= _WIDEST:
            yield from ((f"{name}[{place}]", item) for place, item in enumerate(value))
        else:
            yield name, value


def _flat_lists(lists: Mapping[str, Sequence[Any]]) -> dict[str, Sequence[Any]]:
    columns: dict[str, Sequence[Any]] = {}
    for name, values in lists.items():
        width = len(values[0]) if isinstance(values[0], list) else 0
        if width and all(isinstance(row, list) and len(row) == width for row in values):
            columns |= {f"{name}[{place}]": [row[place] for row in values] for place in range(width)}
        elif not width:
            columns[name] = values
    return columns


def _rows(columns: Mapping[str, Sequence[Any]]) -> int:
    """Return the commonest length of the columns, of equally common ones the longest."""
    lengths = Counter(len(values) for values in columns.values())
    return max(lengths, key=lambda length: (lengths[length], length), default=0)


def _column(values: Sequence[Any]) -> Any:
    """Return numbers as an array, anything else as text."""
    if all(value is None or isinstance(value, bool | int | float) for value in values):
        return np.array([np.nan if value is None else _number(value) for value in values])
    return pd.Series([None if value is None else str(value) for value in values], dtype="str")


def _number(value: bool | int | float) -> float:
    try:
        return float(value)
    except OverflowError:
        return np.nan
