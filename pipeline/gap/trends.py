"""Trends beside a hypothesis: effects that may grow or fade while the machine is recorded.

Which of them are worth a fit follows from the linearisation about the hypothesis, as with changes: what an effect
explains in a block, times how much of it would act there, is one more column of the regression.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from simgap.effects import Effect
from simgap.equations.trend import Trend, trending, trends_of
from simgap.gap.neighbours import RIDGE, Neighbours
from simgap.gap.reading import Reading
from simgap.simulation import FittedEffect

_TRENDS = 0.1
"""Odds that something on a machine changes slowly while it is recorded: motors heat up, grease gets thin."""
_SHAPES = 4
"""Shapes that a trend may have: to an end or in a straight line, up or down; as many through each of several runs."""


@dataclass(frozen=True)
class Trending:
    """An effect that grows or fades.

    Attributes:
        trend: of it.
        effects: of the hypothesis that it belongs to and its own, with values to start a fit from.
        promise: the score that the linearisation gives it.
    """

    trend: Trend
    effects: tuple[FittedEffect, ...]
    promise: float


def trends(near: Neighbours) -> list[Trending]:
    """Return the most promising trend of each effect beside a hypothesis in which nothing changes, best first.

    Args:
        near: the linearisation about it.
    """
    recorded = near.centre.reading.prepared.recorded
    effects = [f.effect for f in (near.mine | near.new).values() if f.effect.key in near.changeable]
    tried = [(e, trend) for e in effects if e.drifts for trend in trends_of(e, recorded)]
    if not tried:
        return []
    columns = [near.contribution(effect.key) for effect, _ in tried]
    shares = np.stack([trend.share(recorded[0])[near.part].numpy() for _, trend in tried])
    weighed = [_weighed(near, *pair, columns[place], shares[place]) for place, pair in enumerate(tried)]
    best: dict[str, Trending] = {}
    for each in sorted(weighed, key=lambda each: -each.promise):
        best.setdefault(each.trend.key, each)
    return list(best.values())


def trending_reading(reading: Reading, trend: Trend) -> Reading:
    """Return a reading in which an effect grows or fades."""
    problem = replace(reading.problem, blocks=trend.marked(reading.problem.blocks), presence=trend)
    prepared = replace(reading.prepared, problem=problem)
    odds = reading.odds * _odds(trend)
    return replace(reading, prepared=prepared, odds=odds, presence=trend, throughout=reading)


def _odds(trend: Trend) -> float:
    """Return the prior odds of one of the trends that a recording allows."""
    return _TRENDS / (_SHAPES * min(len(trend.origins), 2))


def _has_two_sides(effect: Effect) -> bool:
    """Whether an effect may take off what it adds elsewhere: its size may lie on either side of doing nothing."""
    size = effect.parameters[0]
    return size.low < size.neutral < size.high


def _weighed(
    near: Neighbours, effect: Effect, trend: Trend, column: int, share: NDArray[np.float64]
) -> Trending:
    """Return a trend with what the linearisation promises of it, and values to start a fit from."""
    kept = [0, *near.own, column]
    gram = near.gram[..., kept, :][..., kept].copy()
    gram[..., -1, :] *= share[:, None, None]
    gram[..., :, -1] *= share[:, None, None]
    steps = [_step(np.einsum("bc,bcpq->pq", weight, gram)) for weight in near.weights]
    left = np.stack([(gram @ change) @ change for change in steps])
    values = near.value(torch.from_numpy(left))
    best = int(values.argmax())
    factor = -float(steps[best][-1])
    if factor < 0.0 and not _has_two_sides(effect):
        return Trending(trend, (), -math.inf)
    cost = near.cost_of(effect.key) + math.log(_odds(trend))
    promise = near.centre.score + float(values[best] - near.present) + cost
    start = FittedEffect(trending(effect), _sized(effect, near.values_of(effect.key), factor))
    return Trending(trend, (*near.starts_with(()), start), promise)


def _step(total: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what a regression of the first column on the others leaves, as a sum of columns, (columns,)."""
    square = total[1:, 1:]
    square = square + np.diag(RIDGE * np.diag(square) + 1e-300)
    return np.concatenate([[1.0], -np.linalg.solve(square, total[1:, 0])])


def _sized(effect: Effect, values: dict[str, float], factor: float) -> dict[str, float]:
    """Return an effect's values with its size, the first of them, farther from doing nothing by a factor."""
    size = effect.parameters[0]
    scaled = size.neutral + factor * (values[size.name] - size.neutral)
    return values | {size.name: min(max(scaled, size.low), size.high)}
