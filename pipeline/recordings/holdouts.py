"""Which runs are held out: about a share of the recorded seconds, of runs that others resemble.

A group is one run, or the two directions of one test: they stay together.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_DECIMALS = 6  # of a distance, beyond which runs resemble each other alike
_SLACK = (
    0.02  # of all seconds; groups that differ by less are equally long: tests by hand end a few tenths apart
)
_LEFT = 0.5  # of all seconds, and of all groups, that are left to fit
_ROUNDING = 1e-9

Chooser = Callable[[Sequence[int], Sequence[int]], int]
"""Returns which of some groups is taken, given these and all that are left."""


@dataclass(frozen=True)
class Groups:
    """Runs that stay together, in the order in which they are drawn.

    Attributes:
        runs: the indices of each group's runs.
        seconds: that each group lasts, s.
    """

    runs: list[tuple[int, ...]]
    seconds: list[float]

    @property
    def most_taken(self) -> int:
        """How many groups need not be fitted."""
        return int((1.0 - _LEFT) * len(self.runs))

    @property
    def most_seconds(self) -> float:
        """How long these may last together, s."""
        return (1.0 - _LEFT) * sum(self.seconds) * (1.0 + _ROUNDING)


def groups_of(order: Sequence[int], seconds: Sequence[float], pairs: Sequence[tuple[int, int]]) -> Groups:
    """Return the groups that runs make.

    Where all runs are the two directions of one test, each is a group: one direction held out says more than nothing.

    Args:
        order: of the runs, by index.
        seconds: that each run lasts, s.
        pairs: of runs that are the two directions of one test.
    """
    partner = {one: pair for pair in pairs for one in pair}
    runs: list[tuple[int, ...]] = list(dict.fromkeys(partner.get(run, (run,)) for run in order))
    runs = runs if len(runs) > 1 else [(run,) for run in order]
    return Groups(runs, [sum(seconds[run] for run in group) for group in runs])


def chosen(
    groups: Groups, share: float, choose: Chooser, taken: Sequence[int] = (), at_least_one: bool = False
) -> list[int]:
    """Return the indices of groups that last about a share of all seconds.

    As long as they last less, another one is taken that exceeds the share by no more than is lacking. Half of the
    seconds and half of the groups stay.

    Args:
        groups: to choose from.
        share: of all seconds.
        choose: which of those that are short enough is taken.
        taken: groups that have gone elsewhere.
        at_least_one: whether one of the shortest is taken if all are too long.
    """
    seconds, found = groups.seconds, list[int]()
    wanted, slack = share * sum(seconds), _SLACK * sum(seconds)
    while (held := sum(seconds[group] for group in found)) < wanted * (1.0 - _ROUNDING):
        gone = [*found, *taken]
        left = [group for group in range(len(seconds)) if group not in gone]
        room = groups.most_seconds - sum(seconds[group] for group in gone)
        allowed = [group for group in left if seconds[group] <= room and len(gone) < groups.most_taken]
        fitting = [group for group in allowed if seconds[group] <= 2.0 * (wanted - held) + slack]
        if allowed and not fitting and not found and at_least_one:
            shortest = min(seconds[group] for group in allowed)
            fitting = [group for group in allowed if seconds[group] <= shortest + slack]
        if not fitting:
            break
        found.append(choose(fitting, left))
    return found


def first(among: Sequence[int], left: Sequence[int]) -> int:
    """Take the group that was drawn first."""
    return among[0]


def most_alike(groups: Groups, distances: NDArray[np.float64]) -> Chooser:
    """Return what takes the group whose every run resembles a run of another group most.

    Of two groups that are nearest to each other, that is the one which is nearer to all.

    Args:
        groups: all of them.
        distances: between runs, (runs, runs), see `simgap.recordings.resemblance`.
    """
    rounded = distances.round(_DECIMALS)

    def apart(group: int, left: Sequence[int]) -> tuple[float, float]:
        others = [run for other in left if other != group for run in groups.runs[other]]
        between = rounded[np.ix_(groups.runs[group], others)]
        return float(between.min(axis=1).max()), float(between.sum(axis=1).mean())

    return lambda among, left: min(among, key=lambda group: apart(group, left))
