"""From the columns of a table to signals whose clock is the row number."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.euler import add_quaternions
from simgap.logs.header_units import unit_in
from simgap.logs.log import Log, Signal
from simgap.logs.long_table import long_signals

_DENSE = 0.75  # share of rows with a value; a column below has rows of its own, or is written on change only
_MOSTLY = 0.5  # share of numbers from which a column with words in it is one of numbers
_STAMPS = (("secs", "nsecs"), ("sec", "nanosec"), ("sec", "nsec"))
_WIDEST = 64  # numbers in one cell; a robot has fewer joints


def log_of_table(
    frame: pd.DataFrame,
    path: Path,
    name: str,
    units: Mapping[str, str] | None = None,
    facts: Mapping[str, str] | None = None,
    remarks: tuple[str, ...] = (),
) -> Log:
    """Return a table as a log: each column is a signal at the rows where it has values.

    A column of dates becomes seconds since its first; one of lists, as "[0.1, 0.2]", becomes name[0], name[1]. A table
    whose rows are a time, a name and a value has one signal a name. Seconds and nanoseconds in two columns, as ROS
    writes them, become one. Roll, pitch and yaw get their quaternion beside them.

    Args:
        frame: the columns.
        path: of the file.
        name: of the format.
        units: column to unit, where the file declares it; names carry units, too.
        facts: what the file says beside the columns.
        remarks: what was damaged.

    Raises:
        InputError: when there are no rows.
    """
    if not len(frame) or not len(frame.columns):
        raise InputError("has no samples", str(path), "record it again, or give another file")
    rows = np.arange(len(frame), dtype="float64")
    signals: dict[str, Signal] = {}
    texts: dict[str, NDArray[np.object_]] = {}
    said = list(remarks)
    long = long_signals(frame)
    if long is not None:
        frame, signals = frame[[long[0]]], {signal.name: signal for signal in long[1]}
    for column in frame.columns:
        title = str(column)
        found = list(_numbers(frame[column], title, said))
        if not found:
            texts[title] = _shared(frame[column])
        for own, values, unit in found:
            declared = (units or {}).get(title)
            signals[own] = _signal(own, rows, values, unit or declared or unit_in(title))
    _join_stamps(signals)
    add_quaternions(signals)
    return Log(name, str(path), signals, facts=facts or {}, remarks=tuple(said), texts=texts, tabular=True)


def _signal(name: str, rows: NDArray[np.float64], values: NDArray[np.float64], unit: str | None) -> Signal:
    known = np.isfinite(values)
    if known.mean() >= _DENSE:
        return Signal(name, rows, values, unit)
    return Signal(name, rows[known], values[known], unit)


def _join_stamps(signals: dict[str, Signal]) -> None:
    """Add the sum of two columns that hold the seconds and the nanoseconds of one stamp."""
    for name in list(signals):
        for ending, fraction in _STAMPS:
            stem = name[: -len(ending)]
            other = signals.get(stem + fraction)
            if not name.endswith(ending) or other is None or len(other.time) != len(signals[name].time):
                continue
            own = stem.strip("._/ ") or "stamp"
            if own not in signals:
                seconds = signals[name]
                since = seconds.values - seconds.values[0] if len(seconds.values) else seconds.values
                signals[own] = Signal(own, seconds.time, since + 1e-9 * other.values, "s")


def _numbers(
    column: pd.Series, name: str, said: list[str]
) -> Iterator[tuple[str, NDArray[np.float64], str | None]]:
    """Yield name, values and unit of what a column holds; nothing where it is text."""
    if pd.api.types.is_datetime64_any_dtype(column.dtype) or pd.api.types.is_timedelta64_dtype(column.dtype):
        yield name, _seconds(column), "s"
    elif pd.api.types.is_numeric_dtype(column.dtype) and not pd.api.types.is_complex_dtype(column.dtype):
        yield name, column.to_numpy(dtype="float64", na_value=np.nan), None
    elif column.isna().all():
        return
    else:
        yield from _from_text(column, name, said)


def _seconds(column: pd.Series) -> NDArray[np.float64]:
    since = column - column.dropna().iloc[0] if column.notna().any() else column
    return np.asarray(
        pd.to_timedelta(since).dt.total_seconds().to_numpy(dtype="float64", na_value=np.nan)
        if column.notna().any()
        else np.full(len(column), np.nan)
    )


def _from_text(
    column: pd.Series, name: str, said: list[str]
) -> Iterator[tuple[str, NDArray[np.float64], str | None]]:
    import pyarrow as pa
    import pyarrow.compute as pc

    try:
        cells = pc.utf8_trim_whitespace(pa.array(column, type=pa.string(), from_pandas=True))
    except (pa.ArrowInvalid, pa.ArrowTypeError):
        return
    first = next((cell for cell in cells[:1000].drop_null().to_pylist() if cell), "")
    if first.startswith("["):
        yield from _from_lists(cells, name)
    elif (times := _times(cells, first)) is not None:
        yield name, times, "s"
    else:
        parsed = _parsed(cells)
        wrong = int(parsed.isna().sum()) - cells.null_count
        if parsed.notna().sum() > _MOSTLY * (len(cells) - cells.null_count):
            if wrong:
                said.append(f"Column {name!r} has {wrong} values that are no numbers; they count as missing.")
            yield name, parsed.to_numpy(dtype="float64"), None


def _parsed(cells: object) -> pd.Series:
    """Return the numbers that texts are, NaN for other words; each different text is looked at once."""
    import pyarrow as pa
    import pyarrow.compute as pc

    encoded = pc.dictionary_encode(cells.combine_chunks() if isinstance(cells, pa.ChunkedArray) else cells)
    words = pd.Series(encoded.dictionary.to_numpy(zero_copy_only=False))
    numbers = np.append(pd.to_numeric(words, errors="coerce").to_numpy(dtype="float64"), np.nan)
    return pd.Series(numbers[pc.fill_null(encoded.indices, len(words)).to_numpy(zero_copy_only=False)])


def _times(cells: object, first: str) -> NDArray[np.float64] | None:
    """Return dates or times of day in seconds since the first; None where the text is something else."""
    if not first[:2].isdigit() or first.count(":") < 1:
        return None
    texts = pd.Series(cells.to_numpy(zero_copy_only=False))  # type: ignore[attr-defined]
    stamps: pd.Series
    if first.count("-") >= 2 or first.count("/") >= 2:
        stamps = pd.to_datetime(texts, errors="coerce", format="ISO8601", utc=True)
    else:
        clock = texts.where(texts.isna() | (texts.str.count(":") > 1), "00:" + texts.astype(str))
        stamps = pd.Series(pd.to_timedelta(clock, errors="coerce"))
    return _seconds(stamps) if stamps.notna().mean() > _MOSTLY else None


def _from_lists(cells: object, name: str) -> Iterator[tuple[str, NDArray[np.float64], str | None]]:
    """Yield one signal for each place of a column of lists; none where they differ in length or hold words."""
    import pyarrow as pa
    import pyarrow.compute as pc

    parts = pc.split_pattern(pc.utf8_trim(cells, "[] "), ",")
    lengths = pc.list_value_length(parts).drop_null().unique().to_pylist()
    if len(lengths) != 1 or not 0 < lengths[0] <= _WIDEST or parts.null_count:
        return
    try:
        flat = pc.cast(pc.utf8_trim_whitespace(pc.list_flatten(parts)), pa.float64())
    except pa.ArrowInvalid:
        return
    values = flat.to_numpy(zero_copy_only=False).reshape(-1, lengths[0])
    for place in range(lengths[0]):
        yield f"{name}[{place}]", np.ascontiguousarray(values[:, place]), None


def _shared(column: pd.Series) -> NDArray[np.object_]:
    """Return text as objects, each different one once."""
    codes, unique = pd.factorize(column)
    known = np.array([*unique, None], dtype=object)
    return np.asarray(known[codes])
