"""A mapping: which signal of a log is which column of the contract, as a YAML file that a person can correct."""

import difflib
import math
from collections.abc import Iterable
from collections.abc import Mapping as AbstractMapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from simgap.artifacts.plain_yaml import read_yaml
from simgap.errors import InputError
from simgap.logs.log import Span
from simgap.recordings.contract import COLUMNS, KINDS, channel_units
from simgap.recordings.units import conversion, factor_and_offset

_ENTRY_KEYS = (
    "from",
    "unit",
    "scale",
    "sign",
    "offset",
    "root",
    "missing",
    "held",
    "times",
    "ratio",
    "integrate",
)
_GENERAL_KEYS = ("kind", "runs", "rate")


@dataclass(frozen=True)
class Source:
    """Where a column comes from: sign · scale · signal + offset, in `unit`.

    Attributes:
        signal: its name in the log.
        unit: of the scaled value; None where the log or else the contract says it.
        scale: factor.
        sign: +1 or −1.
        offset: in `unit`, added last.
        root: whether the column is the square root of that: a motor command is a speed, and some logs have a thrust.
        missing: a code that stands for no value.
        held: whether a value holds until the next one; None where the log says it.
        times: a second signal that multiplies this one: the supply voltage of a duty cycle.
        ratio: numbers of the platform that multiply this signal, as `drive.gear_ratio / wheel_radius`.
        integrate: whether the column is the integral of the signal over time, from zero in each run: a position that
            was not recorded, of a velocity. `unit` is that of the signal.
    """

    signal: str
    unit: str | None = None
    scale: float = 1.0
    sign: int = 1
    offset: float = 0.0
    root: bool = False
    missing: float | None = None
    held: bool | None = None
    times: str | None = None
    ratio: str | None = None
    integrate: bool = False


@dataclass(frozen=True)
class Mapping:
    """The columns of a recording, as signals of a log.

    Attributes:
        kind: quadrotor, swerve or joint.
        columns: column of the contract, `t` or `run` to its source.
        windows: the runs that a person marks; empty where the log marks them, or all of it is one run.
        rate: samples per second of the recording; None where the slowest of the measured signals sets them.
    """

    kind: str
    columns: AbstractMapping[str, Source]
    windows: tuple[Span, ...] = ()
    rate: float | None = None


def read_mapping(path: Path, kind: str | None = None) -> Mapping:
    """Read a mapping from a YAML file.

    The file is {column: {from, unit, scale, sign, …}} beside `kind`, and optional `runs` ({name: [begin, end]}, s)
    and `rate` (Hz). A column may be the name of a signal alone.

    Args:
        path: of the file.
        kind: of the platform, where the file does not say it.

    Raises:
        InputError: when it cannot be read, or a key, a unit or a number is wrong.
    """
    return mapping_from_config(read_yaml(path), str(path), kind)


def mapping_from_config(content: Any, where: str = "mapping", kind: str | None = None) -> Mapping:
    """Make a mapping of the content of its file; see `read_mapping`.

    Raises:
        InputError: when a key, a unit or a number is wrong.
    """
    if not isinstance(content, AbstractMapping) or not content:
        raise InputError("is no mapping of columns", where, "write COLUMN: {from: SIGNAL, unit: UNIT}")
    kind = content.get("kind", kind)
    if kind not in KINDS:
        raise InputError(
            "says no kind of machine" if kind is None else f"{kind!r} is no kind of platform",
            f"{where}, kind",
            f"write kind: and one of {', '.join(KINDS)}",
        )
    given = {str(key): value for key, value in content.items() if key not in _GENERAL_KEYS}
    columns = {column: _source(column, entry, where) for column, entry in given.items()}
    sliding = any(_base(columns.get(name)) in ("m", "m/s") for name in ("position", "velocity"))
    units = channel_units(str(kind), sliding) | {"t": "s", "run": ""}
    for column, source in columns.items():
        _check_column(column, source, units, str(kind), f"{where}, {column}")
    return Mapping(
        str(kind), columns, _windows(content.get("runs"), where), _rate(content.get("rate"), where)
    )


def completed(mapping: Mapping, names: Iterable[str]) -> Mapping:
    """Return a mapping that takes as they are the columns of the contract that it does not mention.

    Args:
        mapping: corrections of a table that has the contract's names.
        names: of the table's columns.
    """
    known = {"run", "t", *COLUMNS[mapping.kind]}
    plain = {name: Source(name) for name in names if name in known}
    return replace(mapping, columns={**plain, **mapping.columns})


def mapping_to_config(mapping: Mapping) -> dict[str, Any]:
    """Return the content of a mapping's file, without what has its default."""
    content: dict[str, Any] = {"kind": mapping.kind}
    for column, source in mapping.columns.items():
        content[column] = source_to_config(source)
    if mapping.windows:
        content["runs"] = {window.name: [window.begin, window.end] for window in mapping.windows}
    if mapping.rate is not None:
        content["rate"] = mapping.rate
    return content


def source_to_config(source: Source) -> dict[str, Any]:
    """Return one entry of a mapping's file, without what has its default."""
    default = Source("")
    named = {
        key: getattr(source, key) for key in _ENTRY_KEYS[1:] if getattr(source, key) != getattr(default, key)
    }
    return {"from": source.signal, **named}


def _source(column: str, entry: Any, where: str) -> Source:
    place = f"{where}, {column}"
    if isinstance(entry, str):
        return Source(entry)
    if not isinstance(entry, AbstractMapping) or not isinstance(entry.get("from"), str):
        raise InputError("names no signal", place, "write {from: SIGNAL, unit: UNIT}")
    for key in entry:
        if key not in _ENTRY_KEYS:
            near = difflib.get_close_matches(str(key), _ENTRY_KEYS, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else f"use {', '.join(_ENTRY_KEYS)}"
            raise InputError(f"unknown key {key!r}", place, remedy)
    sign, held = entry.get("sign", 1), entry.get("held")
    root, integrate = entry.get("root", False), entry.get("integrate", False)
    if sign not in (1, -1) or isinstance(sign, bool):
        raise InputError(f"sign is {sign!r}", place, "give 1 or -1")
    for key, value in (("held", held), ("integrate", integrate), ("root", root)):
        if value is not None and not isinstance(value, bool):
            raise InputError(f"{key} is {value!r}", place, "give true or false")
    return Source(
        signal=entry["from"],
        unit=None if entry.get("unit") is None else str(entry["unit"]),
        scale=_number(entry.get("scale", 1.0), f"{place}, scale"),
        sign=int(sign),
        offset=_number(entry.get("offset", 0.0), f"{place}, offset"),
        root=bool(root),
        missing=None if entry.get("missing") is None else _number(entry["missing"], f"{place}, missing"),
        held=held,
        times=None if entry.get("times") is None else str(entry["times"]),
        ratio=None if entry.get("ratio") is None else str(entry["ratio"]),
        integrate=bool(integrate),
    )


def _check_column(
    column: str, source: Source, units: AbstractMapping[str, str], kind: str, place: str
) -> None:
    if column not in units:
        near = difflib.get_close_matches(column, units, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else "see docs/contract.md for the names"
        raise InputError(f"unknown column {column!r} for a {kind}", place, remedy)
    if source.root and units[column] != "1":
        raise InputError(
            f"has a root, and is in {units[column]}",
            place,
            "leave root out: only a command without a unit is one",
        )
    if source.unit is None:
        return
    factor_and_offset(source.unit, f"{units[column]}/s" if source.integrate else units[column], place)


def _base(source: Source | None) -> str | None:
    found = conversion(source.unit) if source and source.unit else None
    return found[0] if found else None


def _number(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{value!r} is not a number", place, "give a number")
    return float(value)


def _windows(content: Any, where: str) -> tuple[Span, ...]:
    if content is None:
        return ()
    place = f"{where}, runs"
    if not isinstance(content, AbstractMapping):
        raise InputError(
            "names no runs", place, "write runs: {NAME: [begin, end]}, in seconds of the log's clock"
        )
    windows = []
    for name, pair in content.items():
        if not isinstance(pair, list) or len(pair) != 2:
            raise InputError(f"{pair!r} is no window", f"{place}, {name}", "give [begin, end], in seconds")
        begin, end = (_number(value, f"{place}, {name}") for value in pair)
        if not begin < end:
            raise InputError(f"ends at {end:g} s before it begins", f"{place}, {name}", "give [begin, end]")
        windows.append(Span(str(name), begin, end))
    return tuple(windows)


def _rate(content: Any, where: str) -> float | None:
    if content is None:
        return None
    rate = _number(content, f"{where}, rate")
    if rate <= 0:
        raise InputError(f"is {rate:g}", f"{where}, rate", "give samples per second, above zero")
    return rate
