"""Which column of a table divides it into runs: by its name, and by what it says."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.logs.guessing.words import said_by, words_of
from simgap.logs.log import Log
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposed

_RUN_WORDS = frozenset((
    "run", "runs", "trial", "trials", "episode", "episodes", "test", "tests", "experiment", "experiments", "flight",
    "flights", "session", "segment", "maneuver", "maneuvers", "manoeuvre", "manoeuver", "lap", "laps", "attempt",
    "repetition", "rep", "take", "recording", "versuch",
))  # fmt: skip
_NEVER = frozenset((
    "mode", "state", "status", "flag", "enabled", "enable", "armed", "gear", "direction", "level", "type", "comment",
    "note", "message", "frame", "time", "sec", "secs", "s", "id", "unit", "error", "fault", "event",
))  # fmt: skip
_MOST = 2000  # different names; more are no names of runs
_MOST_UNNAMED = 200  # likewise of a column whose name says nothing
_FEWEST_ROWS = 5  # of a run, on average
_LONG = 20  # rows of the shortest stretch of a column whose name says nothing
_FEWEST_COUNTED = 3  # runs that are counted; two may be a switch
_BREAK = 10.0  # median steps of the clock; a longer one is a pause
_ASKED = 0.6  # confidence where a person has to say it


@dataclass(frozen=True)
class _Division:
    """A column that may divide a table.

    Attributes:
        name: of the column.
        codes: number of each row's value, (n,), −1 where it has none.
        text: whether it holds words.
        counts: whether it counts up by one, from 0 or 1.
    """

    name: str
    codes: NDArray[np.int64]
    text: bool
    counts: bool

    @property
    def known(self) -> NDArray[np.int64]:
        """Rows that have a value."""
        return np.flatnonzero(self.codes >= 0)

    @property
    def starts(self) -> NDArray[np.int64]:
        """Rows at which another value begins, without the first."""
        rows = self.known
        return rows[1:][np.diff(self.codes[rows]) != 0]


def run_of(log: Log, time: Proposed | None) -> Proposed | None:
    """Propose the column that names the run; None where no column divides the table.

    Args:
        log: a table.
        time: its column of time, where there is one.
    """
    found = [each for division in _divisions(log) if (each := _proposed(division, log, time)) is not None]
    return max(found, key=lambda each: each.confidence, default=None)


def _divisions(log: Log) -> Iterator[_Division]:
    for name, text in log.texts.items():
        yield _Division(name, pd.factorize(text)[0].astype(np.int64), True, False)
    for name, signal in log.signals.items():
        values = signal.values
        if np.isfinite(values).all() and (values == np.round(values)).all():
            codes, numbers = pd.factorize(values)
            counts = len(numbers) > 1 and bool((np.diff(numbers) == 1).all()) and numbers[0] in (0, 1)
            yield _Division(name, codes.astype(np.int64), False, counts)


def _proposed(division: _Division, log: Log, time: Proposed | None) -> Proposed | None:
    rows, count = len(division.known), int(division.codes.max(initial=-1)) + 1
    stretches = len(division.starts) + 1
    if not 1 <= count <= min(_MOST, rows / _FEWEST_ROWS) or stretches > 0.5 * rows:
        return None
    if not set(words_of(division.name)) & _RUN_WORDS:
        return _unnamed(division, log, time) if 2 <= count <= _MOST_UNNAMED and stretches == count else None
    if stretches > count:
        why = f"its {count} values come back, in {stretches} stretches: is each value one run?"
        return Proposed(Source(division.name), _ASKED, why)
    runs = f"{count} run{'' if count == 1 else 's'}"
    return Proposed(
        Source(division.name), 0.95 if division.text else 0.93, f"by its name, {runs} one after another"
    )


def _unnamed(division: _Division, log: Log, time: Proposed | None) -> Proposed | None:
    """Propose a column by what it says alone: long stretches, each with a value of its own."""
    words, said = set(words_of(division.name)), said_by(division.name)
    if words & _NEVER or said.quantity or said.other or said.commanded:
        return None
    edges = np.concatenate([[division.known[0]], division.starts, [len(division.codes)]])
    shortest, count = int(np.diff(edges).min()), len(edges) - 1
    if shortest < _LONG or not (division.text or division.counts):
        return None
    why = f"each of its {count} values is one stretch of at least {shortest} rows"
    if _breaks(division, log, time):
        return Proposed(Source(division.name), 0.92, f"{why}, and the clock breaks off between them")
    if not division.text and count < _FEWEST_COUNTED:
        return None
    return Proposed(Source(division.name), _ASKED, f"{why}: are they runs? Else delete this line")


def _breaks(division: _Division, log: Log, time: Proposed | None) -> bool:
    """Whether the clock goes back or pauses wherever another value begins."""
    if time is None or len(log.signals[time.source.signal].values) != len(division.codes):
        return False
    steps = np.diff(log.signals[time.source.signal].values, prepend=np.nan)
    usual = float(np.nanmedian(steps))
    breaks = ~((steps >= 0) & (steps <= _BREAK * usual))
    return bool(breaks[division.starts].all())
