"""Faults of single rows: what a register, a sensor or a clock does to a part of a column. They are mended, and said."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from simgap.recordings.recording import Recording, recording_from_frame

Change = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class RowFault:
    """A way to spoil some rows of a column.

    Attributes:
        name: in the table.
        column: that is spoilt.
        change: of the column in one run.
        said: what has to stand in a warning of the cleaned recording, beside the column.
    """

    name: str
    column: str
    change: Change
    said: str

    def possible(self, recording: Recording) -> bool:
        """Whether a recording has the column, and something happens in it."""
        return self.column == "t" or (
            self.column in recording.channels and recording.frame[self.column].abs().max() > 0.0
        )

    def of(self, recording: Recording) -> Recording:
        """Return the spoilt recording, read as a file of it would be."""
        runs = recording.frame.groupby("run", sort=False)[self.column]
        frame = recording.frame.assign(**{self.column: runs.transform(self._changed)})
        if self.column != "t":
            return replace(recording, frame=frame)
        sliding = recording.units.get("position") == "m"
        return recording_from_frame(frame, recording.kind, sliding=sliding)

    def _changed(self, values: pd.Series) -> np.ndarray:
        return self.change(values.to_numpy(dtype=float))


def overflowing(bits: int) -> Change:
    """Return a register of so many bits that holds six tenths of the values."""

    def change(values: np.ndarray) -> np.ndarray:
        quantum = 1.2 * np.nanmax(np.abs(values)) / 2**bits
        half = 2 ** (bits - 1)
        return ((np.round(values / quantum) + half) % 2**bits - half) * quantum

    return change


def sign_and_size(values: np.ndarray) -> np.ndarray:
    """Return numbers of 16 bits whose highest one is the sign; the sizes fill five sixths of the rest."""
    quantum = 1.2 * np.nanmax(np.abs(values)) / 2**15
    ticks = np.round(values / quantum)
    return np.where(ticks < 0, 2**15 - ticks, ticks) * quantum


def dead(values: np.ndarray) -> np.ndarray:
    """Return values of which a fifteenth stands still at the largest one."""
    result = values.copy()
    result[_fastest(values)] = values[_fastest(values)][0]
    return result


def zeros(values: np.ndarray) -> np.ndarray:
    """Return values of which a fifteenth, from the largest one on, is zero."""
    result = values.copy()
    result[_fastest(values)] = 0.0
    return result


def _fastest(values: np.ndarray) -> slice:
    length = len(values) // 15
    first = min(int(np.nanargmax(np.abs(values))), len(values) - length)
    return slice(first, first + length)


def restarted(values: np.ndarray) -> np.ndarray:
    """Return times that begin anew in the middle."""
    middle = len(values) // 2
    return np.concatenate([values[:middle], values[middle:] - values[middle]])


def _joint() -> Iterator[RowFault]:
    for bits in (12, 16):
        yield RowFault(f"velocity wraps at 2^{bits}", "velocity", overflowing(bits), "wraps at")
    yield RowFault("position wraps at 2^12", "position", overflowing(12), "wraps at")
    yield RowFault("velocity with a sign bit", "velocity", sign_and_size, "its sign in its highest bit")
    yield RowFault("velocity dead", "velocity", dead, "repeats one value")
    yield RowFault("velocity zero for a while", "velocity", zeros, "repeats one value")
    yield RowFault("battery at 0 V", "battery_voltage", zeros, "which no battery does")
    yield RowFault("clock starts anew", "t", restarted, "starts anew")


ROW_FAULTS: dict[str, tuple[RowFault, ...]] = {"joint": tuple(_joint())}
"""The faults of rows of each kind that has a position and its rate."""
