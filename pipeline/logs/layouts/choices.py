"""Which of several signals is taken for a group of columns."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from simgap.logs.common_times import step_of
from simgap.logs.log import Log
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposed

_WORTH = 2.0  # times as fast, for a signal to be taken instead of a better one

AXES = (1, -1, -1)
"""Signs from north, east, down to x forward, y left, z up; and from forward, right, down."""

QUATERNION = (1, 1, -1, -1)
"""Signs of w, x, y, z for the same."""


@dataclass(frozen=True)
class Choice:
    """Signals that may be a group of columns, in its order.

    Attributes:
        signals: one for each column.
        reason: why they are, in a few words.
        signs: one for each column; empty for +1.
        unit: of the scaled values.
        confidence: from 0 to 1.
        scales: factors, one for each column; empty for 1.
        offsets: in `unit`, one for each column; empty for 0.
        held: whether a value holds until the next one.
    """

    signals: Sequence[str]
    reason: str
    signs: Sequence[int] = ()
    unit: str | None = None
    confidence: float = 1.0
    scales: Sequence[float] = ()
    offsets: Sequence[float] = ()
    held: bool | None = None

    def columns(self, names: Sequence[str]) -> dict[str, Proposed]:
        """Return the proposed columns.

        Args:
            names: of the columns, as many as there are signals.
        """
        return {
            name: Proposed(
                Source(
                    signal,
                    unit=self.unit,
                    sign=self.signs[index] if self.signs else 1,
                    scale=self.scales[index] if self.scales else 1.0,
                    offset=self.offsets[index] if self.offsets else 0.0,
                    held=self.held,
                ),
                self.confidence,
                self.reason,
            )
            for index, (name, signal) in enumerate(zip(names, self.signals, strict=True))
        }


def choose(log: Log, choices: Iterable[Choice]) -> Choice | None:
    """Return the first choice that is there, or a later one that is much faster; None where none is there."""
    present = [choice for choice in choices if all(rate_of(log, name) > 0 for name in choice.signals)]
    best: Choice | None = None
    for choice in present:
        if best is None or rate_of(log, choice.signals[0]) > _WORTH * rate_of(log, best.signals[0]):
            best = choice
    return best


def rate_of(log: Log, name: str) -> float:
    """Return the samples per second of a signal; 0 where it is not there, or has fewer than two values."""
    if name not in log.signals:
        return 0.0
    signal = log.signals[name]
    known = signal.time[np.isfinite(signal.values)]
    step = step_of(known)
    return 1.0 / step if 0 < step < np.inf else 0.0


def vector(topic: str, fields: Iterable[str], reason: str, signs: Sequence[int], unit: str) -> Choice:
    """Return the choice of some fields of one topic."""
    return Choice([f"{topic}.{field}" for field in fields], reason, signs, unit)


def moves(log: Log, names: Iterable[str]) -> bool:
    """Whether any of some signals changes."""
    return any(np.ptp(values) > 0 for name in names if len(values := _finite(log, name)))


def middle(log: Log, name: str) -> float:
    """Return the median of a signal; 0 where it has no values."""
    values = _finite(log, name)
    return float(np.median(values)) if len(values) else 0.0


def largest(log: Log, name: str) -> float:
    """Return the largest size of a signal; 0 where it has no values."""
    return float(np.abs(_finite(log, name)).max(initial=0.0))


def _finite(log: Log, name: str) -> np.ndarray:
    values = log.signals[name].values if name in log.signals else np.empty(0)
    return values[np.isfinite(values)]


def number(log: Log, fact: str) -> float | None:
    """Return a parameter of the vehicle; None where the log does not say it."""
    try:
        return float(log.facts[fact])
    except (KeyError, ValueError):
        return None
