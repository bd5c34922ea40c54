"""Tables with units on disk: Parquet, and CSV with the same header."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from simgap.artifacts.bounded import first_bytes
from simgap.errors import InputError
from simgap.recordings.contract import WHOLE_NUMBERS
from simgap.recordings.text_table import read_text_table, text_dialect

_MAGIC = b"PAR1"
TEXT_TABLES = (".csv", ".tsv", ".tab", ".txt", ".dat", ".asc")
"""How the names of tables end that are written as text."""

WORKBOOKS = (".xlsx", ".xls", ".xlsm", ".ods")
"""How the names of workbooks end, which are not read: a sheet is saved as CSV."""
_ROW_NUMBERS = re.compile(
    r"__index_level_\d+__"
)  # what pandas adds, to Parquet by this name and to CSV without one
_REPEATED = ["run", *WHOLE_NUMBERS]
_STRUCTURED = (
    "simgap.split",
    "simgap.clock_offset",
    "simgap.noise_kept",
    "simgap.derived",
    "simgap.cleaned",
    "simgap.warnings",
)


@dataclass(frozen=True)
class Table:
    """What a file holds, before it is checked against the contract.

    Attributes:
        frame: the columns as stored.
        units: column to declared unit, for those that declare one.
        metadata: file metadata; structured entries decoded.
        remarks: sentences about the way it was stored.
    """

    frame: pd.DataFrame
    units: dict[str, str] = field(default_factory=dict)
    metadata: dict[str, Any] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def read_table(path: Path) -> Table:
    """Read Parquet or CSV.

    Raises:
        InputError: when the file is missing, unreadable, empty or neither of the two.
    """
    magic = first_bytes(path, len(_MAGIC))
    if magic == _MAGIC:
        return _read_parquet(path)
    if path.suffix.lower() in WORKBOOKS:
        raise InputError("is a workbook of a spreadsheet program", str(path), "save the sheet as CSV")
    if is_text_table(path):
        return _read_text(path)
    raise InputError(
        "is not a Parquet file", str(path), "give a Parquet file, or a CSV file whose name ends in .csv"
    )


def is_text_table(path: Path) -> bool:
    """Whether a file's name is that of a table of text, packed by gzip or not."""
    name = path.name.lower().removesuffix(".gz")
    return name.endswith(TEXT_TABLES)


def header_of(path: Path) -> list[str]:
    """Return the names of the columns of Parquet or CSV, without reading the rows.

    Raises:
        InputError: when the file is missing, unreadable or empty.
    """
    if first_bytes(path, len(_MAGIC)) == _MAGIC:
        try:
            return [str(name) for name in pq.read_schema(path).names]
        except (pa.ArrowException, OSError, ValueError) as error:
            reason = str(error).splitlines()[0]
            raise InputError(f"is a damaged Parquet file ({reason})", str(path), "write it again") from None
    return list(text_dialect(path).names)


def _read_parquet(path: Path) -> Table:
    try:
        file = pq.ParquetFile(path)
        schema = file.schema_arrow
        _refuse_duplicates(schema.names, path)
        names = [name for name in schema.names if not _ROW_NUMBERS.fullmatch(name)]
        # One after the other, so that one column only is held twice.
        frame = pd.DataFrame({name: _column(file, name) for name in names}, copy=False)
        pa.default_memory_pool().release_unused()
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(f"is a damaged Parquet file ({reason})", str(path), "write it again") from None
    units = {
        entry.name: entry.metadata[b"unit"].decode("utf-8", "replace")
        for entry in schema
        if entry.metadata and b"unit" in entry.metadata
    }
    return Table(frame, units, _decode(schema.metadata or {}, path))


def _column(file: pq.ParquetFile, name: str) -> pd.Series:
    """Return a column, in memory of its own that may be written to."""
    series = file.read(columns=[name], use_threads=False).column(name).to_pandas()
    return series.copy() if series.dtype == np.float64 else series


def _decode(raw: Mapping[bytes, bytes], path: Path) -> dict[str, Any]:
    text = {key.decode("utf-8", "replace"): value.decode("utf-8", "replace") for key, value in raw.items()}
    metadata: dict[str, Any] = {
        key: text[key] for key in ("platform_kind", "source", "licence") if key in text
    }
    for key in _STRUCTURED:
        if key in text:
            try:
                metadata[key] = json.loads(text[key])
            except ValueError:
                raise InputError("is not JSON", f"{path}, metadata {key!r}", "write the file again") from None
    return metadata


def _read_text(path: Path) -> Table:
    table = read_text_table(path)
    return Table(table.frame, table.units, remarks=table.remarks)


def _refuse_duplicates(names: list[str], path: Path) -> None:
    repeated = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if repeated is not None:
        raise InputError("appears twice in the file", f"{path}, column {repeated!r}", "keep one of them")


def write_table(
    frame: pd.DataFrame, units: Mapping[str, str], metadata: Mapping[str, object], path: Path
) -> None:
    """Write Parquet with an explicit schema, a unit per field and metadata; same content, same bytes.

    Raises:
        InputError: when the file cannot be written.
    """
    fields = [_field(str(column), units) for column in frame.columns]
    encoded = {
        key: json.dumps(value, sort_keys=True, ensure_ascii=False) if key in _STRUCTURED else str(value)
        for key, value in metadata.items()
    }
    schema = pa.schema(fields, metadata=encoded)
    arrays = [_array(frame[entry.name], entry.type) for entry in schema]
    try:
        # Measured numbers hardly repeat: a dictionary of them is built in vain. The system's memory is that of NumPy's
        # arrays, so that what they no longer need is used again.
        pq.write_table(
            pa.Table.from_arrays(arrays, schema=schema),
            path,
            use_dictionary=_REPEATED,
            memory_pool=pa.system_memory_pool(),
        )
        for pool in (pa.default_memory_pool(), pa.system_memory_pool()):
            pool.release_unused()
    except OSError as error:
        raise InputError(
            f"cannot be written ({error.strerror or error})",
            str(path),
            "check the folder's permissions and space",
        ) from None


def _field(column: str, units: Mapping[str, str]) -> pa.Field:
    if column == "run":
        return pa.field(column, pa.string(), nullable=False)
    if column in WHOLE_NUMBERS:
        return pa.field(column, pa.int64(), nullable=False)
    return pa.field(column, pa.float64(), metadata={"unit": "s" if column == "t" else units.get(column, "1")})


def _array(series: pd.Series, kind: pa.DataType) -> pa.Array:
    if kind == pa.float64():
        # NaN, not null: one way to say that a sample is missing
        return pa.array(series.to_numpy(dtype="float64"), type=kind, from_pandas=False)
    found = pa.array(series, type=kind, from_pandas=False)
    return found.combine_chunks() if isinstance(found, pa.ChunkedArray) else found
