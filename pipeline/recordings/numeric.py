"""Conversion of columns to numbers; text, infinity and impossible values are refused with their location."""

import numpy as np
import pandas as pd

from simgap.errors import InputError

_LARGEST = 1e9  # in SI units nothing a robot measures comes near; above, float32 and squares overflow
_LATEST = 1e12  # seconds since 1970 fit easily


def location(where: str, frame: pd.DataFrame | pd.Series, row: int, column: str) -> str:
    """Return "file, run, row, column" for an error; `row` counts from 0 here and is shown from 1."""
    runs = frame["run"] if isinstance(frame, pd.DataFrame) else frame
    return f"{where}, run {runs.iloc[row]!r}, row {row + 1}, column {column!r}"


def to_numbers(series: pd.Series, runs: pd.Series, where: str) -> np.ndarray:
    """Return a column as float64, missing samples as NaN; one that is so already is not copied.

    Args:
        series: the column, of any type.
        runs: the run of each row, to name in an error.
        where: the file, to name in an error.

    Raises:
        InputError: on text, dates, infinity and magnitudes beyond any physical one.
    """
    column = str(series.name)
    values = _parse(series, runs, where, column)
    most = _LATEST if column == "t" else _LARGEST
    if np.fmax.reduce(values, initial=0.0) <= most and np.fmin.reduce(values, initial=0.0) >= -most:
        return values
    infinite = np.isinf(values)
    if infinite.any():
        place = location(where, runs, int(np.argmax(infinite)), column)
        raise InputError("infinity is not a measurement", place, "leave the value out where there is none")
    row = int(np.argmax(np.abs(np.nan_to_num(values)) > most))
    raise InputError(
        f"{values[row]:.3g} is beyond any measurement",
        location(where, runs, row, column),
        "correct it, or leave the value out",
    )


def _parse(series: pd.Series, runs: pd.Series, where: str, column: str) -> np.ndarray:
    if pd.api.types.is_complex_dtype(series.dtype) or pd.api.types.is_datetime64_any_dtype(series.dtype):
        raise InputError(
            f"holds {series.dtype}, not numbers", f"{where}, column {column!r}", "give plain numbers"
        )
    if pd.api.types.is_timedelta64_dtype(series.dtype):
        return series.dt.total_seconds().to_numpy(dtype="float64", copy=True)
    if series.dtype == np.float64:
        return series.to_numpy()
    if pd.api.types.is_numeric_dtype(series.dtype):
        return series.to_numpy(dtype="float64", copy=True, na_value=np.nan)
    text = series.astype(object).where(series.notna(), None)
    parsed = [_number(value) for value in text]
    wrong = next((row for row, value in enumerate(parsed) if value is None), None)
    if wrong is not None:
        place = location(where, runs, wrong, column)
        raise InputError(
            f"{str(text.iloc[wrong])[:40]!r} is not a number", place, "give a number, or no value"
        )
    return np.array(parsed, dtype="float64")


def _number(value: object) -> float | None:
    """Return the number, NaN for a missing value, None for anything else."""
    if value is None or (isinstance(value, str) and not value.strip()):
        return float("nan")
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return None
