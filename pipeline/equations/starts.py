"""Where the fits of effects begin: scans that are evaluated once for a recording.

Many effects have a size that only a step can tell and a shape that only a scan can find. What an effect changes at each
point of its scan hardly depends on the other effects, so it is worked out beside the nominal simulator and used beside
every other.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import torch
from torch import Tensor

from simgap.effects import Effect
from simgap.equations.fit import Fit, bounded_newton_step, bounds_of, effect_jacobian, summand_of
from simgap.equations.problem import Problem
from simgap.equations.temper import energy_of
from simgap.simulation import FittedEffect, Simulator

_SCANNED = 60
"""Blocks that rank the points of a scan, drawn evenly."""


@dataclass(frozen=True)
class _Point:
    """What an effect changes at one point of its scan.

    Attributes:
        values: of its parameters.
        taken: what it takes off the residual, (blocks, rows, channels).
        columns: of its parameters there, (blocks, rows, channels, parameters).
        loudness: of the rows there, see `Problem.loudness`, (channels,).
    """

    values: dict[str, float]
    taken: Tensor
    columns: Tensor
    loudness: Tensor


class Starts:
    """The scans of all effects for one problem."""

    def __init__(self, nominal: Simulator, problem: Problem, throughout: "Starts | None" = None) -> None:
        """Prepare; an effect is scanned when it is asked for.

        Args:
            nominal: beside which the effects are scanned.
            problem: what is fitted.
            throughout: the scans for the same rows where all effects act throughout. Those of effects that still do
                are the same.
        """
        self.nominal, self.problem, self.throughout = nominal, problem, throughout
        self.few, self.part = some_of(problem)
        self.scans: dict[str, list[_Point]] = {}

    def of(self, effect: Effect) -> list[dict[str, float]]:
        """Return the points of an effect's scan."""
        blocks = self.problem.blocks
        return effect.starts_in(blocks.signals | blocks.resolution, self.nominal.constants())

    def ranked(self, effect: Effect, current: Fit) -> list[dict[str, float]]:
        """Return the points of an effect's scan in the order of what one Newton step promises beside a fit."""
        points = self._scan(effect)
        noise = (self.few.loudness(current.simulator) * self.few.noise).square().clamp_min(1e-24)
        residual = current.residual[self.part]
        mixture = self.few.temper.mixture(energy_of(residual, noise), noise)

        def value(point: _Point) -> float:
            louder = noise * point.loudness**2
            left = energy_of(self._left(effect, point, current), louder)
            return float(self.few.temper.value_of(mixture, left, louder).sum())

        return [point.values for point in sorted(points, key=value, reverse=True)]

    def _scan(self, effect: Effect) -> list[_Point]:
        partly = self.problem.presence is not None and effect.key in self.problem.presence.keys
        if self.throughout and not partly:
            return self.throughout._scan(effect)
        if effect.key not in self.scans:
            point = self._summand if self._only_adds(effect) else self._point
            self.scans[effect.key] = [point(effect, values) for values in self.of(effect)]
        return self.scans[effect.key]

    def _only_adds(self, effect: Effect) -> bool:
        known = any(fitted.effect.key == effect.key for fitted in self.nominal.known)
        return not known and self.few.is_sum_with(self.nominal, effect)

    def _summand(self, effect: Effect, values: dict[str, float]) -> _Point:
        taken, columns = summand_of(effect, values, self.nominal, self.few)
        return _Point(values, taken, columns, self.few.loudness(self.nominal))

    def _point(self, effect: Effect, values: dict[str, float]) -> _Point:
        kept = tuple(f for f in self.nominal.known if f.effect.key != effect.key)
        simulator = self.nominal.with_effects((*kept, FittedEffect(effect, values)))
        residual = self.few.residual(simulator)
        columns = effect_jacobian(simulator, effect, self.few, residual)
        return _Point(values, self._base - residual, columns, self.few.loudness(simulator))

    @cached_property
    def _base(self) -> Tensor:
        return self.few.residual(self.nominal)

    def _left(self, effect: Effect, point: _Point, current: Fit) -> Tensor:
        """Return what one Newton step from a point beside a fit leaves, (blocks, rows, channels)."""
        residual = current.residual[self.part] - point.taken
        jacobian = torch.cat([current.jacobian[self.part], point.columns], dim=-1)
        low, high = bounds_of(current.simulator)
        own = effect.parameters
        low = torch.cat([low, low.new_tensor([parameter.low for parameter in own])])
        high = torch.cat([high, high.new_tensor([parameter.high for parameter in own])])
        values = torch.cat([current.values, low.new_tensor(list(point.values.values()))])
        change, _ = bounded_newton_step(jacobian, residual, current.scale[self.part], values, low, high)
        return residual - jacobian @ (change.minimum(high - values).maximum(low - values))


def some_of(problem: Problem) -> tuple[Problem, Tensor]:
    """Return a problem with a part of its blocks, drawn evenly, and the places of those."""
    part = torch.linspace(0, len(problem.blocks) - 1, min(_SCANNED, len(problem.blocks))).round().long()
    return replace(problem, blocks=problem.blocks.take(part), cluster=problem.cluster[part]), part
