"""The formats of logs that can be read, and how each is known by its first bytes or its name."""

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from simgap.artifacts.bounded import first_bytes
from simgap.errors import InputError
from simgap.logs.log import Log
from simgap.recordings.storage import WORKBOOKS, is_text_table

_HEAD = 512  # bytes that are looked at
_TAIL = 1 << 16  # bytes at the end of a Parquet file that hold the names of its columns


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


def _ends(path: Path, *endings: str) -> bool:
    return path.name.lower().endswith(endings)


_SYSID = (b'"slow-', b'"fast-', b'"sysid"')  # names of its tests, and its mark


def _is_sysid(path: Path, head: bytes) -> bool:
    return _ends(path, ".json") and any(name in head for name in _SYSID)


FORMATS: tuple[Format, ...] = (
    Format("WPILOG", "wpilog", lambda path, head: head.startswith(b"WPILOG")),
    Format("SysId JSON", "sysid_json", _is_sysid),
    Format("PX4 ULog", "ulog", lambda path, head: head.startswith(b"ULog\x01\x12\x35")),
    Format("ArduPilot DataFlash", "dataflash", lambda path, head: head.startswith(b"\xa3\x95")),
    Format("ROS 1 bag", "bag", lambda path, head: head.startswith(b"#ROSBAG V")),
    Format(
        "ROS 2 bag",
        "bag",
        lambda path, head: head.startswith(b"SQLite format 3\0") or (path / "metadata.yaml").is_file(),
    ),
    Format("MCAP", "bag", lambda path, head: head.startswith(b"\x89MCAP0\r\n")),
    Format("LeRobot data set", "lerobot", lambda path, head: _is_lerobot(path, head)),
    Format(
        "Crazyflie log",
        "crazyflie",
        lambda path, head: head[:1] == b"\xbc" and head[1:3] in (b"\1\0", b"\2\0"),
    ),
    Format("Blackbox", "blackbox", lambda path, head: _is_blackbox(path, head)),
    Format("Parquet", "table", lambda path, head: head.startswith(b"PAR1")),
    Format("numpy archive", "arrays", lambda path, head: _ends(path, ".npz")),
    Format("JSON table", "json_table", lambda path, head: _ends(path, ".json", ".jsonl", ".ndjson")),
    Format("CSV", "table", lambda path, head: is_text_table(path) or _ends(path, *WORKBOOKS)),
)
"""Every format, the more specific ones first; tables, which anything else may be, last."""


def _is_lerobot(path: Path, head: bytes) -> bool:
    """Whether a folder has the description of a LeRobot data set, or a table the columns of one."""
    if path.is_dir():
        return (path / "meta" / "info.json").is_file()
    if not head.startswith(b"PAR1"):
        return False
    with path.open("rb") as file:  # the names of the columns stand at the end
        file.seek(max(0, path.stat().st_size - _TAIL))
        tail = file.read()
    return b"observation.state" in tail and b"episode_index" in tail


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
    head = b"" if path.is_dir() else first_bytes(path, _HEAD)
    for entry in FORMATS:
        if entry.matches(path, head):
            return entry
    known = ", ".join(entry.name for entry in FORMATS)
    raise InputError("is of no known format", str(path), f"give one of: {known}")


def _is_blackbox(path: Path, head: bytes) -> bool:
    """Whether a file is a log of Betaflight or INAV: by its first line, or by a name that only these have."""
    return b"H Product:Blackbox" in head or path.suffix.lower() in (".bbl", ".bfl", ".bbs")
