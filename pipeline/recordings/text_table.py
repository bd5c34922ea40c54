"""Tables as text: CSV as people export it, read into columns."""

import io
import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as arrow_csv

from simgap.errors import InputError
from simgap.recordings.dialect import NO_VALUE, Dialect, dialect_of
from simgap.recordings.packed import opened

_HEAD = 1 << 18  # bytes in which the names of the columns have to stand
_RETRIES = (
    8  # columns that turn out to be text behind the first rows, before all others are taken for text, too
)
_FAILED_COLUMN = re.compile(r"In CSV column #(\d+): (?!.*UTF8)")
_FAILED_ROW = re.compile(r"Row #(\d+): Expected (\d+) columns, got (\d+)")
_NO_ROWS = "Empty CSV file"
_COMMENTS = ("#", "%", "//")
_BLANKS = re.compile(r"[ \t]+")


@dataclass(frozen=True)
class TextTable:
    """A table that was written as text.

    Attributes:
        frame: columns as float64, bool or text.
        units: column to unit, from a row of units.
        remarks: sentences about what was left out.
    """

    frame: pd.DataFrame
    units: dict[str, str]
    remarks: tuple[str, ...] = ()


def read_text_table(path: Path) -> TextTable:
    """Read a table of text: with any usual separator, decimal sign and encoding, packed by gzip or not.

    A column with one cell that is no number is text, so that an error can name the cell. Rows that are too short and
    comments are left out and counted.

    Raises:
        InputError: when it is no table; the line of the first wrong row is named.
    """
    where = str(path)
    dialect = text_dialect(path)
    _refuse_duplicates(dialect.names, where)
    short = _ShortRows()
    try:
        table = _columns(path, dialect, short)
    except (OSError, EOFError, zlib.error) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"cannot be read ({reason})", where, "give an undamaged file") from None
    units = {name: unit for name, unit in zip(dialect.names, dialect.units, strict=False) if name and unit}
    frame = table.to_pandas(split_blocks=True, self_destruct=True, ignore_metadata=True)
    return TextTable(frame, units, short.remarks(len(frame), dialect, where))


def text_dialect(path: Path) -> Dialect:
    """Return how a table is written as text, from its first rows.

    Raises:
        InputError: when it is no text, or has no row of names.
    """
    try:
        with opened(path, str(path)) as file:
            head = file.read(_HEAD)
            complete = not file.read(1)
    except (OSError, EOFError, zlib.error) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"cannot be read ({reason})", str(path), "give an undamaged file") from None
    if not complete:
        end = head.rfind(b"\n") + 1
        head = head[: end + end % 2] if end else head  # a line of UTF-16 ends behind two bytes
    return dialect_of(head, str(path))


def _refuse_duplicates(names: tuple[str, ...], where: str) -> None:
    seen: set[str] = set()
    for name in names:
        if name and name in seen:
            raise InputError("appears twice in the file", f"{where}, column {name!r}", "keep one of them")
        seen.add(name)


class _ShortRows:
    """What was left out between the samples."""

    def __init__(self) -> None:
        self.count, self.first = 0, 0

    def handle(self, row: Any) -> str:
        """Say whether a row with another number of cells is skipped."""
        if row.text.lstrip().startswith(_COMMENTS):
            return "skip"
        if row.actual_columns > row.expected_columns:
            return "error"
        self.count += 1
        self.first = self.first or (row.number or 0)
        return "skip"

    def remarks(self, rows: int, dialect: Dialect, where: str) -> tuple[str, ...]:
        """Return a sentence on rows that were too short; too many of them are an error."""
        if not self.count:
            return ()
        line = self.first + dialect.line - 1
        if self.count > 1 and self.count * 10 > rows:
            raise InputError(
                f"{self.count} rows have fewer values than the header",
                f"{where}, line {line}",
                "give every row the columns of the header",
            )
        rows_are = "row has" if self.count == 1 else "rows have"
        return (
            f"{self.count} {rows_are} fewer values than the header (line {line}), and were left out: cut off?",
        )


def _columns(path: Path, dialect: Dialect, short: _ShortRows) -> pa.Table:
    """Return the columns; those that turn out to be text are read again as such."""
    where = str(path)
    names = [name or f"\0{place}" for place, name in enumerate(dialect.names)]
    texts = {"run", *dialect.texts}
    for attempt in range(len(names) + 1):
        short.count = short.first = 0
        types: dict[str, Any] = dict.fromkeys(names, pa.float64())
        types |= dict.fromkeys(dialect.flags - texts, pa.bool_()) | dict.fromkeys(texts, pa.string())
        try:
            table = _parsed(path, dialect, names, types, short)
            break
        except pa.ArrowInvalid as error:
            if _NO_ROWS in str(error):
                table = pa.table({name: pa.array([], type=types[name]) for name in names})
                break
            failed = _FAILED_COLUMN.search(str(error))
            if failed is None:
                raise _refusal(str(error), dialect, where) from None
            texts |= {names[int(failed[1])]} if attempt < _RETRIES else set(names)
    table = table.select([name for name in names if not name.startswith("\0")])
    for name in set(table.column_names) & texts - {"run"}:
        place = table.column_names.index(name)
        table = table.set_column(place, name, _numbers_if_all(table.column(place), dialect))
    return table


def _parsed(
    path: Path, dialect: Dialect, names: list[str], types: dict[str, Any], short: _ShortRows
) -> pa.Table:
    with opened(path, str(path)) as file:
        return arrow_csv.read_csv(
            _from(file, dialect),
            read_options=arrow_csv.ReadOptions(
                column_names=names, use_threads=False, encoding=_encoding(dialect)
            ),
            parse_options=arrow_csv.ParseOptions(
                delimiter="\t" if dialect.separator == " " else dialect.separator,
                invalid_row_handler=short.handle,
            ),
            convert_options=arrow_csv.ConvertOptions(
                column_types={name: types[name] for name in names},
                null_values=list(NO_VALUE),
                strings_can_be_null=True,
                decimal_point=dialect.decimal,
            ),
        )


def _encoding(dialect: Dialect) -> str:
    return "utf-8" if dialect.separator == " " else dialect.encoding


def _from(file: io.BufferedIOBase, dialect: Dialect) -> io.BufferedIOBase:
    """Return the file from its first sample on."""
    left = dialect.offset
    while left and (skipped := file.read(min(left, _HEAD))):
        left -= len(skipped)
    if dialect.separator != " ":
        return file
    text = file.read().decode(dialect.encoding, "replace")  # runs of blanks separate
    lines = (_BLANKS.sub("\t", line.strip(" \t\r")) for line in text.split("\n"))
    return io.BytesIO("\n".join(lines).encode())


def _refusal(reason: str, dialect: Dialect, where: str) -> InputError:
    if "UTF8" in reason or "UTF-8" in reason:
        return InputError("is not a text file", where, "give CSV in UTF-8, or Parquet")
    row = _FAILED_ROW.search(reason)
    if row is None:
        return InputError(
            f"is not a table ({reason.splitlines()[0][:80]})", where, "give every row the same columns"
        )
    number, expected, found = (int(value) for value in row.groups())
    if number == 1:
        return InputError("rows have more columns than the header", where, "name every column")
    line = number + dialect.line - 1
    return InputError(
        f"line {line} has {found} values instead of {expected}",
        where,
        "give every row the columns of the header",
    )


def _numbers_if_all(column: pa.ChunkedArray, dialect: Dialect) -> pa.ChunkedArray:
    """Return a column of text as numbers where every value is one, once blanks and thousands are taken out."""
    cells = pc.utf8_trim_whitespace(column)
    if dialect.thousands:
        sign, decimal = re.escape(dialect.thousands), re.escape(dialect.decimal)
        grouped = rf"^[+-]?\d{{1,3}}({sign}\d{{3}})*({decimal}\d*)?([eE][+-]?\d+)?$"
        plain = rf"^[+-]?(\d+({decimal}\d*)?|{decimal}\d+)([eE][+-]?\d+)?$"
        fits = pc.or_(pc.match_substring_regex(cells, grouped), pc.match_substring_regex(cells, plain))
        if not pc.all(fits).as_py():
            return column
        cells = pc.replace_substring(cells, dialect.thousands, "")
    if dialect.decimal == ",":
        cells = pc.replace_substring(cells, ",", ".")
    try:
        return pc.cast(pc.if_else(pc.is_in(cells, pa.array(NO_VALUE)), None, cells), pa.float64())
    except pa.ArrowInvalid:
        return column
