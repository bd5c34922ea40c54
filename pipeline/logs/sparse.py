"""Sparse tables: values written on change only, or in rows of each topic's own."""

from dataclasses import replace
from pathlib import Path

import pandas as pd

from simgap.logs.apply import recording_of
from simgap.logs.log import Log
from simgap.logs.mapping import Mapping, Source
from simgap.logs.proposal import lacking
from simgap.logs.tabular import log_of_table
from simgap.recordings.cleaning.channels import INPUTS
from simgap.recordings.contract import ANY_OF, KINDS, REQUIRED, channel_units
from simgap.recordings.recording import Recording
from simgap.recordings.storage import Table

_COMPLETE = 0.5  # share of rows with all that is needed; below, the rows are those of several topics
_ON_CHANGE = 0.5  # of the values of the fullest column; an effort with fewer is a command, not a measurement


def recording_of_sparse(table: Table, path: Path, kind: str | None) -> Recording | None:
    """Return a table with the contract's columns whose rows are those of several topics; None for any other.

    Commands hold until the next one; what is measured is interpolated to the times of its slowest column.

    Args:
        table: as stored.
        path: of the file.
        kind: quadrotor, swerve or joint; None where the columns say it.

    Raises:
        InputError: when no run has samples of all columns.
    """
    present = set(map(str, table.frame.columns))
    declared = table.metadata.get("platform_kind") or kind
    found = declared or next((each for each in KINDS if not lacking(each, present)), None)
    if found not in KINDS or "simgap.cleaned" in table.metadata or not _is_sparse(table.frame, str(found)):
        return None
    log = log_of_table(table.frame, path, "table", table.units, remarks=table.remarks)
    units = channel_units(str(found))
    columns = {
        name: Source(name) for name in ("t", "run", *units) if name in log.signals or name in log.texts
    }
    held = held_inputs(log, {name: name for name in columns}, str(found))
    columns |= {name: replace(columns[name], held=True) for name in held}
    recording = recording_of(log, Mapping(str(found), columns))
    return replace(recording, warnings=(*recording.warnings, *_said(log, held)))


def held_inputs(log: Log, signals: dict[str, str], kind: str) -> list[str]:
    """Return the columns that are commands written on change only, so that each value holds until the next one.

    Args:
        log: a table.
        signals: column of the contract to the name of its signal.
        kind: quadrotor, swerve or joint.
    """
    fullest = max(
        (len(log.signals[name].time) for name in signals.values() if name in log.signals), default=0
    )
    held = []
    for column, name in signals.items():
        if column not in INPUTS[kind] or name not in log.signals:
            continue
        count = len(log.signals[name].time)
        measured = column == "effort" and count >= _ON_CHANGE * fullest
        if count < _rows(log) and not measured:
            held.append(column)
    return held


def _rows(log: Log) -> int:
    ends = [int(signal.time[-1]) + 1 for signal in log.signals.values() if len(signal.time)]
    return max([*ends, *(len(text) for text in log.texts.values())], default=0)


def _is_sparse(frame: pd.DataFrame, kind: str) -> bool:
    """Whether few rows have values of all columns that are needed, though each column has some."""
    required = [name for name in REQUIRED[kind] if name in frame]
    groups = [list(group) for group in ANY_OF[kind] if set(group) <= set(frame.columns)]
    needed = frame[required].notna()
    if any(frame[name].isna().all() for name in required) or (ANY_OF[kind] and not groups):
        return False
    whole = needed.all(axis=1)
    if groups:
        whole &= pd.concat([frame[group].notna().all(axis=1) for group in groups], axis=1).any(axis=1)
        if not any(frame[group].notna().any().all() for group in groups):
            return False
    return bool(len(frame)) and float(whole.mean()) < _COMPLETE


def _said(log: Log, held: list[str]) -> tuple[str, ...]:
    rows = _rows(log)
    counts = ", ".join(f"{name!r} {len(log.signals[name].time)}" for name in held)
    kept = f" Held until the next value, as commands are: {counts} of {rows} rows." if held else ""
    return (f"A sparse table: its columns have rows of their own, and were brought to common times.{kept}",)
