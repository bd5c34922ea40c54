"""Validation of a table as a recording; each error is one line with file, run, row and column."""

import difflib
from collections.abc import Iterable

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.clocks import clock_remedy, runs_of_one_clock
from simgap.recordings.contract import (
    ANY_OF,
    DERIVED_FROM,
    INDEX_COLUMNS,
    KINDS,
    REQUIRED,
    TOGETHER,
    WHOLE_NUMBERS,
    channel_units,
    required_channels,
)
from simgap.recordings.numeric import location, to_numbers
from simgap.recordings.runs import by_run, stretches_of_runs
from simgap.recordings.units import conversion, factor_and_offset

_QUATERNION = [f"attitude_{axis}" for axis in "wxyz"]
_NORM_TOLERANCE = 0.1  # a logged quaternion is off by rounding; beyond this it is not a rotation


def resolve_kind(declared: object, expected: str | None, frame: pd.DataFrame, where: str) -> str:
    """Return the kind that the file declares, else the one whose required columns are there.

    Args:
        declared: what the file says.
        expected: what it is taken for where it neither says nor has all columns of another kind.
        frame: the table as stored.
        where: the file, to name in an error.

    Raises:
        InputError: when the declared kind is unknown or no kind fits.
    """
    if declared:
        if declared not in KINDS:
            raise InputError(
                f"unknown kind {declared!r}", f"{where}, platform_kind", f"use one of {', '.join(KINDS)}"
            )
        return str(declared)
    present = set(frame.columns)
    share = {kind: _share_of(kind, present) for kind in KINDS}
    best = max(share, key=lambda kind: share[kind])
    if expected in KINDS and share[best] < 1:
        return str(expected)
    if share[best] == 0:
        shown = ", ".join(map(str, list(frame.columns)[:6]))
        raise InputError(
            f"none of the expected columns is there (columns: {shown})",
            where,
            "use the column names of docs/contract.md",
        )
    return best


def _share_of(kind: str, present: set[str]) -> float:
    """Return the share of the columns of a kind that are there; of those that may be absent together, some count."""
    usual = (*REQUIRED[kind], *DERIVED_FROM.get(kind, {}))
    sets = (usual, (*usual, *TOGETHER[kind]))
    return max(len(present & set(columns)) / len(columns) for columns in sets)


def validate(
    frame: pd.DataFrame, declared: dict[str, str], kind: str, where: str
) -> tuple[pd.DataFrame, dict[str, str], tuple[str, ...]]:
    """Check a table and convert it to the columns, units and types of the contract.

    Args:
        frame: the table as stored.
        declared: column to unit, where the file declares one.
        kind: quadrotor, swerve or joint.
        where: the file, to name in an error.

    Returns:
        The frame (runs contiguous, columns in the order of the contract), units by channel, and remarks on
        what was left out.

    Raises:
        InputError: when the table cannot be used.
    """
    if frame.empty:
        raise InputError("has no samples", where, "record it again, or give another file")
    units = channel_units(kind, _is_sliding(kind, declared))
    _require_columns(set(frame.columns), kind, where)
    channels, remarks = _usable(frame, kind, units)
    frame = frame.reset_index(drop=True)
    runs = _runs(frame["run"], where)
    columns: dict[str, pd.Series | np.ndarray] = {"run": runs}
    whole = [column for column in WHOLE_NUMBERS if column in frame]
    for column in ["t", *whole, *channels]:
        expected = "s" if column == "t" else units.get(column, "1")
        numbers = to_numbers(frame[column], runs, where)
        converted = _convert(numbers, declared.get(column), expected, f"{where}, column {column!r}")
        # What is right as it is, is shared: pandas copies it when one of the two frames is changed.
        as_it_is = converted is numbers and frame[column].dtype == np.float64
        columns[column] = frame[column] if as_it_is else converted
    result = pd.DataFrame(columns, copy=False)
    result["run"], restarts = runs_of_one_clock(result["run"], result["t"])
    _check_time(result, where)
    for column in whole:
        result[column] = _whole_numbers(result, column, where)
    result, emptied = _without_empty(result, kind, where)
    if kind == "quadrotor":
        _check_quaternions(result, where)
    names, _ = stretches_of_runs(result["run"])
    if len(set(names)) < len(names):
        codes, _ = pd.factorize(result["run"])
        result = result.iloc[np.argsort(codes, kind="stable")].reset_index(drop=True)
    return (
        result,
        {column: units[column] for column in result.columns if column in units},
        (*remarks, *restarts, *emptied),
    )


def _is_sliding(kind: str, declared: dict[str, str]) -> bool:
    telling = [column for column in ("position", "velocity", "position_command") if column in declared]
    found = {column: conversion(declared[column]) for column in telling}
    return kind == "joint" and any(entry and entry[0] in ("m", "m/s") for entry in found.values())


def _require_columns(present: set[str], kind: str, where: str) -> None:
    groups = ANY_OF[kind]
    for column in ("run", "t", *required_channels(kind, present)):
        if column not in present:
            raise InputError(f"column {column!r} is missing", where, _remedy(column, present, kind))
    if groups and not any(set(group) <= present for group in groups):
        begun = max(groups, key=lambda group: len(present & set(group)))
        column = next(name for name in begun if name not in present)
        others = " or ".join(group[0] if len(group) == 1 else f"{group[0]} … {group[-1]}" for group in groups)
        raise InputError(
            f"column {column!r} is missing (needed: {others})", where, _remedy(column, present, kind)
        )


def _remedy(column: str, present: Iterable[str], kind: str) -> str:
    strange = [name for name in present if name not in channel_units(kind) and name not in INDEX_COLUMNS]
    lowered = {name.lower().replace(" ", "_"): name for name in sorted(strange)}
    near = difflib.get_close_matches(column.lower(), lowered, n=1, cutoff=0.75 if len(column) > 3 else 0.6)
    if near:
        return f"did you mean {lowered[near[0]]!r}? rename it"
    if column == "run":
        return "add it: the name of the flight, drive or trial, in every row"
    if column in TOGETHER[kind]:
        stems = sorted({_vector(name) for name in TOGETHER[kind]})
        return f"add it, or leave all of {', '.join(stems)} out"
    return f"add it, a {kind} needs it"


def _usable(frame: pd.DataFrame, kind: str, units: dict[str, str]) -> tuple[list[str], list[str]]:
    """Return the channels to keep, in the order of the contract, and a remark for each column left out."""
    remarks = []
    for column in frame.columns:
        if column not in units and column not in INDEX_COLUMNS:
            near = difflib.get_close_matches(str(column), [name for name in units if name not in frame], n=1)
            hint = f" (did you mean {near[0]!r}?)" if near else ""
            remarks.append(f"Column {str(column)!r} is unknown for a {kind}{hint} and was ignored.")
    channels = [column for column in units if column in frame.columns]
    vectors: dict[str, list[str]] = {}
    for column in units:
        vectors.setdefault(_vector(column), []).append(column)
    for name, members in vectors.items():
        missing = [column for column in members if column not in channels]
        if missing and len(missing) < len(members):
            remarks.append(
                f"Column {missing[0]!r} is missing, so the other components of {name} were ignored."
            )
            channels = [column for column in channels if column not in members]
    return channels, remarks


def _vector(column: str) -> str:
    stem, _, suffix = column.rpartition("_")
    return stem if suffix in tuple("wxyz1234") else column


def _runs(series: pd.Series, where: str) -> pd.Series:
    absent = series.isna().to_numpy()
    if absent.any():
        row = int(np.argmax(absent)) + 1
        raise InputError(
            "the run has no name", f"{where}, row {row}, column 'run'", "name the run in every row"
        )
    return series.astype(str)


def _convert(numbers: np.ndarray, declared: str | None, expected: str, where: str) -> np.ndarray:
    if declared is None:
        return numbers
    factor, offset = factor_and_offset(declared, expected, where)
    return numbers * factor + offset if (factor, offset) != (1.0, 0.0) else numbers


def _check_time(frame: pd.DataFrame, where: str) -> None:
    unknown = frame["t"].isna().to_numpy()
    if unknown.any():
        row = int(np.argmax(unknown))
        raise InputError(
            "no time is given", location(where, frame, row, "t"), "give a time, or leave the row out"
        )
    names, edges = stretches_of_runs(frame["run"])
    if len(set(names)) == len(names):
        time = frame["t"].to_numpy()
        wrong = np.append(False, time[1:] <= time[:-1])
        wrong[edges[:-1]] = False
    else:
        wrong = (frame.groupby("run", sort=False)["t"].diff() <= 0).to_numpy()
    if wrong.any():
        row = int(np.argmax(wrong))
        step = frame["t"][frame["run"] == frame["run"].iloc[row]].diff()[row]
        what = "the same time appears twice" if step == 0 else f"time goes back by {-step:.6g} s"
        raise InputError(what, location(where, frame, row, "t"), clock_remedy(wrong, bool(step == 0)))


def _whole_numbers(frame: pd.DataFrame, column: str, where: str) -> pd.Series:
    wrong = ~(frame[column] == np.floor(frame[column])).to_numpy()
    if wrong.any():
        row = int(np.argmax(wrong))
        raise InputError("is not a whole number", location(where, frame, row, column), "leave the column out")
    return frame[column].astype("int64")


def _without_empty(frame: pd.DataFrame, kind: str, where: str) -> tuple[pd.DataFrame, list[str]]:
    """Refuse a required channel without values, drop an optional one, and say where a run lacks one."""
    empty = [column for column in frame.columns if column != "run" and frame[column].isna().all()]
    needed = required_channels(kind, frame.columns)
    usable = [group for group in ANY_OF[kind] if set(group) <= set(frame.columns) - set(empty)]
    if ANY_OF[kind] and not usable:
        needed += next(group for group in ANY_OF[kind] if set(group) & set(empty))
    for column in empty:
        if column in needed:
            raise InputError(
                "has no values", f"{where}, all runs, column {column!r}", "give another recording"
            )
    remarks = [f"Column {column!r} has no values and was ignored." for column in empty]
    present = [column for column in frame.columns if column not in empty]
    checked = [*required_channels(kind, present), *(column for group in usable for column in group)]
    checked = [column for column in checked if frame[column].isna().any()]
    lacking: dict[str, list[str]] = {}
    for run, samples in by_run(frame) if checked else ():
        names = ", ".join(column for column in checked if samples[column].isna().all())
        if names:
            lacking.setdefault(names, []).append(run)
    for names, runs in lacking.items():
        said = f"Run {runs[0]!r} has" if len(runs) == 1 else f"{len(runs)} runs, from {runs[0]!r} on, have"
        remarks.append(f"{said} no values in {names}.")
    return frame.drop(columns=empty), remarks


def _check_quaternions(frame: pd.DataFrame, where: str) -> None:
    if _QUATERNION[0] not in frame:
        return
    norm = np.sqrt(sum(np.square(frame[part].to_numpy()) for part in _QUATERNION))
    wrong = np.abs(norm - 1.0) > _NORM_TOLERANCE
    if wrong.any():
        row = int(np.argmax(wrong))
        place = location(where, frame, row, "attitude_w … attitude_z")
        raise InputError(
            f"the quaternion's norm is {norm[row]:.3g}, not 1", place, "give unit quaternions, or no value"
        )
