"""A run during cleaning, with the list of its changes."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from simgap.recordings.cleaning.table import ChannelTable

CHANGE_COLUMNS = ("run", "step", "column", "reason", "samples", "seconds", "detail")
"""A change concerns `samples` values of `column`; where `column` is empty, whole samples that were added
(positive) or dropped (negative), so that recorded + Σ samples = kept for every run."""

COVERAGE_COLUMNS = ("run", "start", "end", "state", "reason")
"""`state` is kept, interpolated, dropped or missing from `start` to `end`, s."""

WHERE = "{runs}"
"""Stands in a remark for the runs that it is said of, so that what is said of several is said once."""

Change = dict[str, object]


@dataclass
class RunUnderCleaning:
    """One run as arrays.

    Attributes:
        name: the run.
        kind: quadrotor, swerve or joint.
        time: s, shape (samples,).
        columns: names of the channels.
        table: the channels, each (samples,); NaN where missing.
        stretch: number of the stretch a sample belongs to; between two stretches nothing is interpolated.
        needed: channels without which a sample is useless.
        time_step: s, the typical one.
        cause: number of the reason why a value is missing or replaced, 0 where it is as recorded, shape (samples,
            channels).
        dropped: number of the reason why a sample is dropped, 0 where it is kept, shape (samples,).
        reasons: by number; the first one is none.
        changes: the ledger.
        remarks: what a reader of the result has to know of them, one sentence each, perhaps with `WHERE`.
        noise_kept: share of white noise that a fifth difference still shows after interpolation.
        filled: whether an input that is needed was made up, shape (samples,).
        clock_offset: s, how late the state is with respect to the motors; None where that is unknown.
    """

    name: str
    kind: str
    time: np.ndarray
    columns: list[str]
    table: ChannelTable
    stretch: np.ndarray
    needed: list[str]
    time_step: float
    cause: np.ndarray = field(default_factory=lambda: np.empty((0, 0), dtype=np.uint8))
    dropped: np.ndarray = field(init=False)
    changes: list[Change] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    clock_offset: float | None = None
    noise_kept: float = 1.0
    filled: np.ndarray = field(init=False)
    reasons: list[str] = field(default_factory=lambda: [""])

    def __post_init__(self) -> None:
        """Start with everything as recorded, where no causes are given."""
        shape = len(self.time), len(self.columns)
        if self.cause.shape != shape:
            self.cause = np.zeros(shape, dtype=np.uint8, order="F")
            for place, values in enumerate(self.table.arrays):
                absent = np.isnan(values)
                if absent.any():
                    self.cause[absent, place] = self.number("missing")
        self.dropped = np.zeros(len(self.time), dtype=np.uint8)
        self.filled = np.zeros(len(self.time), dtype=bool)

    def number(self, reason: str) -> int:
        """Return the number of a reason; a new one gets the next."""
        if reason not in self.reasons:
            self.reasons.append(reason)
        return self.reasons.index(reason)

    @property
    def is_usable(self) -> bool:
        """Whether some sample is kept."""
        return not self.dropped.all()

    def index(self, columns: list[str]) -> list[int]:
        """Return where the channels stand in `table`."""
        return [self.columns.index(column) for column in columns]

    def has(self, columns: list[str]) -> bool:
        """Return whether every one of the channels is there."""
        return set(columns) <= set(self.columns)

    @property
    def values(self) -> np.ndarray:
        """Return a copy of all channels, (samples, channels)."""
        return self.channel(*self.columns)

    def column(self, name: str) -> np.ndarray:
        """Return a channel, (samples,), to be read: no copy, so that it may show what is erased later."""
        return self.table.arrays[self.columns.index(name)]

    def channel(self, *columns: str) -> np.ndarray:
        """Return a copy of channels, (samples, len(columns))."""
        return self.rows(slice(None), columns)

    def rows(self, samples: slice | np.ndarray, columns: Sequence[str]) -> np.ndarray:
        """Return a copy of some samples of channels, (samples, len(columns)), each in one piece of memory."""
        return np.stack([self.column(column)[samples] for column in columns]).T

    def length(self, columns: list[str]) -> np.ndarray:
        """Return the length of the vector that channels are the components of, shape (samples,)."""
        squared, square = np.zeros(len(self.time)), np.empty(len(self.time))
        for column in columns:
            squared += np.square(self.column(column), out=square)
        return np.sqrt(squared, out=squared)

    def erase(self, rows: np.ndarray, columns: list[str], step: str, reason: str, detail: str = "") -> None:
        """Erase values and record the change, once per channel.

        Args:
            rows: mask over samples, shape (samples,).
            columns: the channels concerned.
            step: which step of cleaning does it.
            reason: why, one short sentence.
            detail: what a reader may want to know beyond that.
        """
        at = np.flatnonzero(rows)
        for column in columns:
            place = self.columns.index(column)
            wanted = at[~np.isnan(self.table.arrays[place][at])]
            if len(wanted):
                self.table.own(place)[wanted] = np.nan
            self.cause[wanted, place] = self.number(step)
            self.note(step, column, reason, len(wanted), detail)

    def replace(self, rows: np.ndarray, column: str, values: np.ndarray, step: str, reason: str) -> None:
        """Put other values in the place of recorded ones and record the change.

        Args:
            rows: mask over samples, shape (samples,).
            column: the channel concerned.
            values: of the channel, shape (samples,).
            step: which step of cleaning does it.
            reason: why, one short sentence.
        """
        self.table.own(self.columns.index(column))[rows] = values[rows]
        self.note(step, column, reason, int(rows.sum()))

    def drop(self, rows: np.ndarray, step: str, reason: str, detail: str = "") -> None:
        """Drop whole samples that are not dropped yet, and record the change."""
        wanted = rows & (self.dropped == 0)
        if wanted.any():
            self.dropped[wanted] = self.number(reason)
            self.note(step, "", reason, -int(wanted.sum()), detail)

    def note(
        self,
        step: str,
        column: str,
        reason: str,
        samples: int,
        detail: str = "",
        seconds: float | None = None,
    ) -> None:
        """Write a change into the ledger; nothing is written where no sample changed and no seconds are
        given."""
        if samples == 0 and seconds is None:
            return
        self.changes.append(
            {
                "run": self.name,
                "step": step,
                "column": column,
                "reason": reason,
                "samples": samples,
                "seconds": abs(samples) * self.time_step if seconds is None else seconds,
                "detail": detail,
            }
        )


def changes_table(changes: list[Change]) -> pd.DataFrame:
    """Return the ledger as a table with the columns `CHANGE_COLUMNS`."""
    types = {"samples": "int64", "seconds": "float64"}
    return pd.DataFrame(
        {
            name: pd.Series([change[name] for change in changes], dtype=types.get(name, "str"))
            for name in CHANGE_COLUMNS
        }
    )


def stretches_of(mask: np.ndarray) -> np.ndarray:
    """Return the unbroken stretches of True as rows [first, one past last], shape (stretches, 2)."""
    within = np.zeros(len(mask) + 2, dtype=bool)
    within[1:-1] = mask
    return np.flatnonzero(within[1:] != within[:-1]).reshape(-1, 2)
