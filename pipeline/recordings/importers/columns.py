"""Conversion of table columns to channels of the contract, by declared unit."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.contract import channel_units
from simgap.recordings.numeric import to_numbers
from simgap.recordings.units import factor_and_offset


@dataclass(frozen=True)
class Column:
    """The source of a channel; its value is scale · column + offset, in `unit`.

    Attributes:
        column: name in the file.
        unit: unit of the scaled value; none: the contract's.
        scale: factor, negative to turn a sign.
        offset: in `unit`.
        missing: a code that stands for no value.
    """

    column: str
    unit: str | None = None
    scale: float = 1.0
    offset: float = 0.0
    missing: float | None = None


def vector(
    name: str, columns: Iterable[str], unit: str | None = None, axes: str = "xyz", scale: float = 1.0
) -> dict[str, Column]:
    """Return the columns of a vector, one channel per axis."""
    return {f"{name}_{axis}": Column(column, unit, scale) for axis, column in zip(axes, columns, strict=True)}


def take(
    frame: pd.DataFrame,
    columns: Mapping[str, Column],
    kind: str,
    run: pd.Series,
    where: str,
    sliding: bool = False,
) -> pd.DataFrame:
    """Return `run`, `t` and the channels that `columns` names, in the contract's units.

    Args:
        frame: the table as published.
        columns: channel to column; `t` among them.
        kind: quadrotor, swerve or joint.
        run: the run of each row.
        where: the file, to name in an error.
        sliding: whether a joint's position is in metres.

    Raises:
        InputError: when a column is missing or not numeric, or a unit does not fit.
    """
    expected = {"t": "s"} | channel_units(kind, sliding)
    result = pd.DataFrame({"run": run.to_numpy(dtype=object)})
    for channel, source in columns.items():
        if channel not in expected:
            near = difflib.get_close_matches(channel, expected, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else "see docs/contract.md for the names"
            raise InputError(f"unknown channel {channel!r} for a {kind}", "dataset.options.columns", remedy)
        if source.column not in frame:
            raise InputError(
                f"column {source.column!r} is missing", where, "is it the file that the dataset names?"
            )
        values = to_numbers(frame[source.column], run, where)
        if source.missing is not None:
            values = np.where(values == source.missing, np.nan, values)
        result[channel] = _to_contract(
            values * source.scale + source.offset, source.unit, expected[channel], channel
        )
    return result


def _to_contract(values: np.ndarray, unit: str | None, expected: str, channel: str) -> np.ndarray:
    if unit is None:
        return values
    factor, added = factor_and_offset(unit, expected, f"dataset.options.columns.{channel}.unit")
    return values * factor + added


def check_options(options: Mapping[str, object], known: Iterable[str], importer: str) -> None:
    """Refuse an option that an importer does not have.

    Raises:
        InputError: with the nearest option that it has.
    """
    known = list(known)
    for key in options:
        if key not in known:
            near = difflib.get_close_matches(str(key), known, n=1)
            listed = f"known: {', '.join(known)}" if known else "it has none"
            remedy = f"did you mean {near[0]!r}?" if near else listed
            raise InputError(f"the importer {importer!r} has no option {key!r}", "dataset.options", remedy)
