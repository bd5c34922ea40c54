"""Shares with confidence intervals, and quantiles."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

_Z95 = 1.959964


@dataclass(frozen=True)
class Share:
    """A share of cases.

    Attributes:
        count: number of cases in which something is true.
        total: number of cases.
    """

    count: int | float
    total: int

    @property
    def value(self) -> float:
        """The share; not a number where there are no cases."""
        return self.count / self.total if self.total else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the share (Wilson 1927, Probable inference, JASA 22)."""
        if not self.total:
            return 0.0, 1.0
        n, p, z = self.total, self.value, _Z95
        centre = (p + z * z / (2 * n)) / (1 + z * z / n)
        width = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return max(centre - width, 0.0), min(centre + width, 1.0)

    @property
    def text(self) -> str:
        """The share as text: percent, interval, cases."""
        if not self.total:
            return "no cases"
        low, high = self.interval
        return f"{self.value:.0%} ({low:.0%}–{high:.0%}, {self.count:g} of {self.total})"


def share_of(values: Iterable[bool]) -> Share:
    """Return the share of values that are true."""
    known = [bool(value) for value in values]
    return Share(sum(known), len(known))


def quantile(values: Sequence[float], place: float) -> float:
    """Return a quantile, interpolated linearly; not a number where there are no values."""
    ordered = sorted(values)
    if not ordered:
        return math.nan
    position = place * (len(ordered) - 1)
    below = math.floor(position)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (position - below) * (ordered[above] - ordered[below])
