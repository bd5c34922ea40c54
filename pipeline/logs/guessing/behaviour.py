"""Signals whose names say nothing, known by what they do: one follows a target or stands alone beside it, one is the
derivative of another."""

import itertools

import numpy as np

from simgap.logs.common_times import values_at
from simgap.logs.guessing.motion import moves, slope_of
from simgap.logs.guessing.words import Said
from simgap.logs.log import Log, Signal

_FOLLOWS = 0.9  # correlation with a target, lag included; a servo follows to a few samples
_DERIVATIVE = 0.99  # correlation where nothing but the behaviour speaks for it
_MOST = 12  # signals of which all pairs are compared
_SCORE = 0.6  # of a name that the behaviour gave; below what is used without asking


def by_behaviour(log: Log, said: dict[str, Said]) -> dict[str, Said]:
    """Return what names say, and for logs without a measured position or velocity what the signals show.

    Args:
        log: with times in s.
        said: what the names of its signals say.
    """
    measured = {"position", "velocity"}
    if any(each.quantity in measured and not each.commanded and not each.other for each in said.values()):
        return said
    free = [
        name
        for name, each in said.items()
        if not each.quantity and not each.other and moves(log.signals[name])
    ]
    targets = [name for name, each in said.items() if each.commanded and each.quantity == "position"]
    for target, name in itertools.product(targets, free):
        if _correlation(log.signals[target], log.signals[name]) > _FOLLOWS:
            return said | {name: _as(said[name], "position")}
    if len(targets) == 1 and len(free) == 1:
        return said | {free[0]: _as(said[free[0]], "position")}
    for first, second in itertools.permutations(free[:_MOST], 2):
        slope = slope_of(log.signals[first], log.signals[second])
        if slope is not None and abs(slope.correlation) > _DERIVATIVE:
            return said | {first: _as(said[first], "position"), second: _as(said[second], "velocity")}
    return said


def _as(said: Said, quantity: str) -> Said:
    return Said(quantity, _SCORE, False, False, (), said.words)


def _correlation(target: Signal, signal: Signal) -> float:
    values = values_at(target, signal.time, held=False)
    known = np.isfinite(values) & np.isfinite(signal.values)
    if known.sum() < 2 or np.ptp(values[known]) == 0.0:
        return 0.0
    return float(np.corrcoef(values[known], signal.values[known])[0, 1])
