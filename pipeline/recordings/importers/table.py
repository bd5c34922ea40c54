"""CSV and Parquet files by a map of columns: any log that is a table."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid

from simgap.errors import InputError
from simgap.recordings.contract import KINDS
from simgap.recordings.importers.columns import Column, check_options, take
from simgap.recordings.recording import Recording, recording_from_frame
from simgap.recordings.storage import read_table
from simgap.recordings.units import conversion

_OPTION_KEYS = ("kind", "columns", "run_column", "integrate")


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read tables.

    Args:
        paths: CSV or Parquet files.
        options: `kind`: quadrotor, swerve or joint; `columns`: channel to the name of a column, or {column,
            unit, scale, offset, missing}; `run_column`: the column that names the run (else each file is one,
            named as the file); `integrate`: channel to the channel whose integral over time, from 0, it is.

    Raises:
        InputError: when a file, a column or an option cannot be used.
    """
    check_options(options, _OPTION_KEYS, "table")
    kind = options.get("kind")
    if kind not in KINDS:
        raise InputError(
            f"{kind!r} is no kind of platform", "dataset.options.kind", f"use one of {', '.join(KINDS)}"
        )
    columns = {
        str(channel): _column(channel, entry) for channel, entry in (options.get("columns") or {}).items()
    }
    if "t" not in columns:
        raise InputError("no column of time is named", "dataset.options.columns", "add t")
    integrals = dict(options.get("integrate") or {})
    sliding = any(_unit(columns.get(channel)) in ("m", "m/s") for channel in ("position", "velocity"))
    frames = []
    for path in paths:
        raw = read_table(path).frame
        frame = take(raw, columns, kind, _runs(raw, options.get("run_column"), path), str(path), sliding)
        frames.append(_integrate(frame, integrals))
    remarks = [
        f"Channel {channel!r} was integrated from {rate!r}, from zero." for channel, rate in integrals.items()
    ]
    return recording_from_frame(pd.concat(frames, ignore_index=True), kind, sliding=sliding, warnings=remarks)


def _column(channel: str, entry: Any) -> Column:
    if isinstance(entry, str):
        return Column(entry)
    where = f"dataset.options.columns.{channel}"
    if not isinstance(entry, Mapping) or "column" not in entry:
        raise InputError(
            f"{entry!r} names no column", where, "give a name, or {column, unit, scale, offset, missing}"
        )
    known = [field.name for field in fields(Column)]
    if strange := set(entry) - set(known):
        raise InputError(f"unknown key {min(strange)!r}", where, f"use {', '.join(known)}")
    unit = entry.get("unit")
    scale, offset, missing = (_number(entry, key, where) for key in ("scale", "offset", "missing"))
    return Column(
        str(entry["column"]),
        None if unit is None else str(unit),
        1.0 if scale is None else scale,
        0.0 if offset is None else offset,
        missing,
    )


def _number(entry: Mapping[str, Any], key: str, where: str) -> float | None:
    value = entry.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{value!r} is not a number", f"{where}.{key}", "give a number")
    return float(value)


def _unit(column: Column | None) -> str | None:
    found = conversion(column.unit) if column and column.unit else None
    return found[0] if found else None


def _runs(frame: pd.DataFrame, column: str | None, path: Path) -> pd.Series:
    if column is None:
        return pd.Series([path.stem] * len(frame), dtype=object)
    if column not in frame:
        raise InputError(f"column {column!r} is missing", str(path), "correct dataset.options.run_column")
    return frame[column].astype(str)


def _integrate(frame: pd.DataFrame, integrals: Mapping[str, str]) -> pd.DataFrame:
    for channel, rate in integrals.items():
        if rate not in frame:
            raise InputError(
                f"there is no channel {rate!r} to integrate", "dataset.options.integrate", "name one"
            )
        frame[channel] = 0.0
        for _, samples in frame.groupby("run", sort=False):
            values = samples[rate].interpolate(limit_direction="both").to_numpy(dtype=float)
            integral = cumulative_trapezoid(values, samples["t"].to_numpy(dtype=float), initial=0.0)
            frame.loc[samples.index, channel] = np.asarray(integral)
    return frame
