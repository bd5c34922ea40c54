"""Medians and spreads of laps that were run in turns."""

import statistics
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Laps:
    """Rates of one contender, one per round.

    Attributes:
        rates: control steps of all machines in a second.
    """

    rates: tuple[float, ...]

    @property
    def median(self) -> float:
        """The middle rate."""
        return statistics.median(self.rates)

    @property
    def spread(self) -> tuple[float, float]:
        """The least and the greatest rate."""
        return min(self.rates), max(self.rates)

    def over(self, other: "Laps") -> float:
        """Return how many times as fast as another: the median of the ratios within the rounds."""
        return statistics.median(a / b for a, b in zip(self.rates, other.rates, strict=True))


def in_turns(contenders: dict[str, Callable[[], float]], rounds: int) -> dict[str, Laps]:
    """Run every contender once in each round, each round from another one on.

    Whatever else slows the machine down for a while slows all of them down.
    """
    names = list(contenders)
    rates: dict[str, list[float]] = {name: [] for name in names}
    for name in names:
        contenders[name]()  # compiles
    for turn in range(rounds):
        first = turn % len(names)
        for name in names[first:] + names[:first]:
            rates[name].append(contenders[name]())
    return {name: Laps(tuple(series)) for name, series in rates.items()}
