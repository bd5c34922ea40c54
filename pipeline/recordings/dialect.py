"""How a table is written as text: encoding, separator, decimal sign, and where names, units and samples stand."""

import codecs
import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from simgap.errors import InputError
from simgap.recordings.units import conversion

NO_VALUE = (
    "", "nan", "NaN", "NAN", "-nan", "-NaN", "nan(ind)", "-nan(ind)", "1.#QNAN", "-1.#IND", "null", "Null", "NULL",
    "none", "None", "NONE", "NA", "N/A", "n/a", "<NA>", "-", "--", "#N/A", "#NV", "#NUM!", "#DIV/0!", "missing",
)  # fmt: skip
"""What programs write where there is no value."""

_BOMS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_PLAIN = (
    0.9  # share of ASCII in a text of names and numbers of the western code page; bytes at random have half
)
_SAMPLE_LINES = 200  # that are looked at; above a header hardly anybody writes more than some ten
_SEPARATORS = ("\t", ";", ",", "|")
_COMMENTS = ("#", "%", "//")
_POINT = re.compile(r"[+-]?(\d+\.\d*|\.\d+)([eE][+-]?\d+)?")
_COMMA = re.compile(r"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")
_WHOLE = re.compile(r"[+-]?\d+([eE][+-]?\d+)?")
_GROUPS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")  # 1,234: thousands, or a fraction of three digits
_GROUPED_POINT = re.compile(r"[+-]?\d{1,3}(,\d{3})+\.\d*")  # 1,234.5
_GROUPED_COMMA = re.compile(r"[+-]?\d{1,3}(\.\d{3})+,\d*")  # 1.234,5
_ENDLESS = re.compile(r"[+-]?inf(inity)?", re.IGNORECASE)
_BRACKETS = "[](){} "


@dataclass(frozen=True)
class Dialect:
    """How a text holds a table.

    Attributes:
        encoding: of the text, as Python names it.
        separator: between two cells; a blank stands for any number of blanks.
        decimal: "." or ",".
        thousands: the sign between groups of digits; empty where there is none.
        names: of the columns; empty where a column has none.
        units: as they stand in a row of their own, one a column; empty where there is no such row.
        offset: bytes before the first sample.
        texts: names of the columns whose first cells are no numbers.
        flags: names of those whose first cells are true or false.
        line: number of the first sample's line, from 1.
    """

    encoding: str
    separator: str
    decimal: str
    thousands: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    offset: int
    texts: frozenset[str]
    flags: frozenset[str]
    line: int


def dialect_of(head: bytes, where: str) -> Dialect:
    """Find out how a text holds a table.

    Args:
        head: its first bytes, up to the end of a line if it is longer.
        where: the file, to name in an error.

    Raises:
        InputError: when it is no text, has no row of names, or its decimal sign is not clear.
    """
    text, encoding, mark = _decoded(head, where)
    lines = text.splitlines(keepends=True)[: _SAMPLE_LINES + 1]
    skipped = _comment_lines(lines)
    separator = _separator([line for line in lines[skipped:] if line.strip() and not _is_comment(line)])
    rows = [_cells(line, separator) for line in lines]
    rows = [[] if _is_comment(line) else row for line, row in zip(lines, rows, strict=True)]
    first, width = _first_sample(rows)
    names, units = _header(rows, first, width, lines, separator, where)
    samples = [row for row in rows[first:] if row]
    if len(names) == width - 1 and samples and not any(row[-1] for row in samples if len(row) == width):
        names = (*names, "")  # a separator behind the last value
    decimal, thousands = _decimal(samples, separator, where)
    kinds = _kinds(samples, names, decimal, thousands)
    offset = mark + len("".join(lines[:first]).encode(encoding))
    return Dialect(
        encoding, separator, decimal, thousands, names, units, offset, kinds[0], kinds[1], first + 1
    )


def _decoded(head: bytes, where: str) -> tuple[str, str, int]:
    """Return the text, its encoding, and the length of the mark before it."""
    for mark, encoding in _BOMS:
        if head.startswith(mark):
            return head[len(mark) :].decode(encoding, "replace"), encoding, len(mark)
    if b"\0" not in head:
        try:
            return head.decode("utf-8"), "utf-8", 0
        except UnicodeDecodeError:
            if sum(byte < 128 for byte in head) > _PLAIN * len(head):
                return head.decode("latin-1"), "latin-1", 0
    raise InputError("is not a text file", where, "give CSV in UTF-8, or Parquet")


def _comment_lines(lines: Sequence[str]) -> int:
    return next(
        (place for place, line in enumerate(lines) if line.strip() and not _is_comment(line)), len(lines)
    )


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENTS)


def _separator(lines: Sequence[str]) -> str:
    """Return the sign by which most lines fall into the same number of cells, two or more."""
    best, score = ",", (0.0, 0)
    for separator in (*_SEPARATORS, " "):
        widths = Counter(len(_cells(line, separator)) for line in lines)
        width, count = widths.most_common(1)[0] if widths else (1, 0)
        found = (round(count / max(len(lines), 1), 3), width)
        least = score if separator != " " or score[0] < _PLAIN else (2.0, 0)  # blanks stand inside of names
        if width > 1 and found[0] > least[0]:
            best, score = separator, found
    return best


def _cells(line: str, separator: str) -> list[str]:
    line = line.rstrip("\r\n")
    if not line.strip():
        return []
    if separator == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]


def _first_sample(rows: Sequence[list[str]]) -> tuple[int, int]:
    """Return the place of the first row with a number in it, and the width of the table."""
    widths = Counter(len(row) for row in rows if row)
    width = max(widths, key=lambda count: (widths[count], count)) if widths else 0
    for place, row in enumerate(rows):
        if len(row) >= width > 0 and any(_is_number(cell) for cell in row):
            return place, width
    return len(rows), width


def _header(
    rows: Sequence[list[str]], first: int, width: int, lines: Sequence[str], separator: str, where: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the columns and their units, from the rows above the first sample."""
    above = [place for place in range(first) if rows[place]]
    found = [place for place in above if 0 <= width - len(rows[place]) <= 1 and width > 0]
    if not found:
        commented = _names_in_comment(lines[:first], width, separator)
        if commented:
            return commented, ()
        raise InputError("has no row of names", where, "write the names of the columns in the first row")
    last = rows[found[-1]]
    if len(found) > 1 and len(rows[found[-2]]) == len(last) and _are_units(last):
        return tuple(rows[found[-2]]), tuple(cell.strip(_BRACKETS) for cell in last)
    return tuple(last), ()


def _names_in_comment(lines: Sequence[str], width: int, separator: str) -> tuple[str, ...]:
    """Return names that stand in the last comment, as numpy writes them."""
    for line in reversed(lines):
        if _is_comment(line):
            names = _cells(line.lstrip().lstrip("#%/").strip(), separator)
            if len(names) == width and not any(_is_number(name) for name in names):
                return tuple(names)
    return ()


def _are_units(row: Sequence[str]) -> bool:
    given = [cell.strip(_BRACKETS) for cell in row if cell.strip(_BRACKETS)]
    return bool(given) and sum(conversion(cell) is not None for cell in given) * 2 > len(given)


def _is_number(cell: str) -> bool:
    forms = (_WHOLE, _POINT, _COMMA, _GROUPED_POINT, _GROUPED_COMMA, _ENDLESS)
    return any(form.fullmatch(cell) for form in forms)


def _decimal(rows: Sequence[list[str]], separator: str, where: str) -> tuple[str, str]:
    """Return the decimal sign and that between thousands, as far as the cells show it."""
    cells = [cell for row in rows for cell in row]
    if any(_GROUPED_POINT.fullmatch(cell) for cell in cells):
        return ".", ","
    if any(_GROUPED_COMMA.fullmatch(cell) for cell in cells):
        return ",", "."
    with_comma = [cell for cell in cells if _COMMA.fullmatch(cell) or _GROUPS.fullmatch(cell)]
    if not with_comma:
        return ".", ""
    with_point = [cell for cell in cells if _POINT.fullmatch(cell)]
    point = bool(with_point)
    comma = any(not _GROUPS.fullmatch(cell) for cell in with_comma)
    if point and not comma:
        return ".", ","
    if comma and not point:
        return ",", ""
    remedy = "write numbers with a point, as 1234.5"
    if comma and point:
        fraction = next(cell for cell in with_comma if not _GROUPS.fullmatch(cell))
        raise InputError(f"{fraction!r} has a comma, and {with_point[0]!r} a point", where, remedy)
    raise InputError(f"{with_comma[0]!r} may be a fraction or thousands", where, remedy)


def _kinds(
    rows: Sequence[list[str]], names: Sequence[str], decimal: str, thousands: str
) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names of the columns of text, and of those of true and false."""
    number = _COMMA if decimal == "," else _POINT
    texts, flags = set(), set()
    for place, name in enumerate(names):
        cells = {row[place] for row in rows if place < len(row)} - set(NO_VALUE)
        if cells and {cell.lower() for cell in cells} <= {"true", "false"}:
            flags.add(name)
        elif any(
            not (number.fullmatch(cell) or _WHOLE.fullmatch(cell) or _ENDLESS.fullmatch(cell))
            for cell in cells
        ):
            texts.add(name)
    return frozenset(texts), frozenset(flags)
