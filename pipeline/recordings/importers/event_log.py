"""Binary event logs that Bitcraze's micro-SD deck writes (cfusdlog, version 2)."""

import struct
import zlib
from pathlib import Path

import numpy as np
import pandas as pd

from simgap.errors import InputError

_MAGIC = 0xBC
_VERSION = 2
_TIME = "timestamp"  # µs
_TYPES = {"b": "<i1", "B": "<u1", "h": "<i2", "H": "<u2", "i": "<i4", "I": "<u4", "f": "<f4", "d": "<f8"}
_CHECKSUM = 4  # bytes at the end


def read_event_log(path: Path) -> pd.DataFrame:
    """Return `timestamp` (µs) and the variables of a log that holds one type of event, a row each.

    A file is a header (magic, version, number of event types; of each its number, its name and its variables, each
    written as name(type)), the events (number, timestamp, values) and a CRC-32 of all before.

    Raises:
        InputError: when the file is damaged, cut off or not of this format.
    """
    where = str(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where, "check its path") from None
    if not content or content[0] != _MAGIC:
        raise InputError("is not a log of the micro-SD deck", where, "give the file as the deck wrote it")
    body, checksum = content[:-_CHECKSUM], content[-_CHECKSUM:]
    if zlib.crc32(body) != int.from_bytes(checksum, "little"):
        raise InputError("its checksum is wrong", where, "it was cut off or damaged; copy it again")
    try:
        record, start = _header(body)
    except (struct.error, KeyError, ValueError) as error:
        raise InputError(f"its header cannot be read ({error})", where, "give a log of version 2") from None
    rows, rest = divmod(len(body) - start, record.itemsize)
    if rows == 0 or rest:
        raise InputError("does not end with a whole event", where, "it was cut off; copy it again")
    events = np.frombuffer(body, record, rows, start)
    return pd.DataFrame({str(name): events[name] for name in (record.names or ())[1:]})


def _header(body: bytes) -> tuple[np.dtype, int]:
    """Return the layout of an event, and where the first one begins."""
    version, types = struct.unpack_from("<HH", body, 1)
    if version != _VERSION or types != 1:
        raise ValueError(f"version {version} with {types} types of events")
    place = body.index(b"\0", 7) + 1  # behind the number and the name of the type
    (variables,) = struct.unpack_from("<H", body, place)
    place += 2
    fields = [("event", "<u2"), (_TIME, "<u8")]
    for _ in range(variables):
        end = body.index(b"\0", place)
        name, _, kind = body[place:end].decode("ascii").rstrip(")").rpartition("(")
        fields.append((name, _TYPES[kind]))
        place = end + 1
    return np.dtype(fields), place
