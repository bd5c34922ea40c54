"""The formats of logs that can be read, and how each is known by its first bytes or its name."""

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from simgap.errors import InputError
from simgap.logs.log import Log

_HEAD = 512  # bytes that are looked at


@dataclass(frozen=True)
class Format:
    """A format of logs.

    Attributes:
        name: for messages and docs.
        reader: module in `simgap.logs.readers` with `read(path) -> Log`; imported when it is needed.
        matches: whether a path with these first bytes is of the format; a folder has none.
    """

    name: str
    reader: str
    matches: Callable[[Path, bytes], bool]


FORMATS: tuple[Format, ...] = (
    Format("Blackbox", "blackbox", lambda path, head: _is_blackbox(path, head)),
    Format("Parquet", "table", lambda path, head: head.startswith(b"PAR1")),
    Format("CSV", "table", lambda path, head: path.suffix.lower() in (".csv", ".txt")),
)
"""Every format, the more specific ones first; tables, which anything else may be, last."""


def read_log(path: Path) -> Log:
    """Read a log of any format that is known.

    Args:
        path: a file, or the folder of a format that has several files.

    Raises:
        InputError: when it is missing, damaged or of no known format.
    """
    found = format_of(path)
    return importlib.import_module(f"simgap.logs.readers.{found.reader}").read(path)  # type: ignore[no-any-return]


def format_of(path: Path) -> Format:
    """Return the format of a log.

    Raises:
        InputError: when it is missing or of no known format.
    """
    head = _first_bytes(path)
    for entry in FORMATS:
        if entry.matches(path, head):
            return entry
    known = ", ".join(entry.name for entry in FORMATS)
    raise InputError("is of no known format", str(path), f"give one of: {known}")


def _is_blackbox(path: Path, head: bytes) -> bool:
    """Whether a file is a log of Betaflight or INAV: by its first line, or by a name that only these have."""
    return b"H Product:Blackbox" in head or path.suffix.lower() in (".bbl", ".bfl", ".bbs")


def _first_bytes(path: Path) -> bytes:
    if path.is_dir():
        return b""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except FileNotFoundError:
        raise InputError("does not exist", str(path), "check the path of the recording") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "check its permissions") from None
    if not head:
        raise InputError("is empty", str(path), "record it again, or give another file")
    return head
