"""Where the fits of effects begin: scans that are evaluated once for a recording.

Many effects have a size that only a step can tell and a shape that only a scan can find. What an effect changes at each
point of its scan hardly depends on the other effects, so it is worked out beside the nominal simulator and used beside
every other.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeGuard

import torch
from torch import Tensor

from simgap.effects import ActuatorEffect, DryFriction, Effect, WrenchEffect
from simgap.gap.fit import Fit, Problem, bounded_newton_step, bounds_of, difference_of, effect_jacobian
from simgap.gap.residuals import acting_series, row_weights, windows_of, with_derived
from simgap.gap.temper import energy_of
from simgap.simulation import FittedEffect, Simulator

_REGRESSED, _REWEIGHED = 2, 4
"""Points of a scan whose promise is worked out, and how often rows are weighed anew."""
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

    def __init__(self, nominal: Simulator, problem: Problem) -> None:
        """Prepare; an effect is scanned when it is asked for.

        Args:
            nominal: beside which the effects are scanned.
            problem: what is fitted.
        """
        self.nominal, self.problem = nominal, problem
        self.few, self.part = some_of(problem)
        self.scans: dict[str, list[_Point]] = {}

    def of(self, effect: Effect) -> list[dict[str, float]]:
        """Return the points of an effect's scan."""
        blocks = self.problem.blocks
        return effect.starts_in(blocks.signals | blocks.resolution, self.nominal.constants())

    def ranked(self, effect: Effect, current: Fit) -> list[dict[str, float]]:
        """Return the points of an effect's scan in the order of what one Newton step promises beside a fit."""
        return [point.values for point in self._ranked(effect, self._some(current))]

    def promise(self, effect: Effect, current: Fit) -> float:
        """Return by how much an effect may raise the log likelihood of a fit, by regressions around its best points."""
        some = self._some(current)
        present = self._value(some.residual, self._noise(some))
        best = max(self._settled(effect, point, some) for point in self._ranked(effect, some)[:_REGRESSED])
        return (best - present) * len(self.problem.blocks) / len(self.part)

    def _some(self, current: Fit) -> Fit:
        """Return a fit with the blocks that are scanned."""
        residual, jacobian, scale = (
            part[self.part] for part in (current.residual, current.jacobian, current.scale)
        )
        return replace(current, residual=residual, jacobian=jacobian, scale=scale)

    def _noise(self, some: Fit) -> Tensor:
        return (self.few.loudness(some.simulator) * self.few.noise).square().clamp_min(1e-24)

    def _value(self, residual: Tensor, noise: Tensor) -> float:
        return float(self.few.temper.value(energy_of(residual, noise), noise).sum())

    def _ranked(self, effect: Effect, some: Fit) -> list[_Point]:
        if effect.key not in self.scans:
            base = self.few.residual(self.nominal)
            self.scans[effect.key] = [self._point(effect, values, base) for values in self.of(effect)]
        noise = self._noise(some)
        mixture = self.few.temper.mixture(energy_of(some.residual, noise), noise)

        def value(point: _Point) -> float:
            louder = noise * point.loudness**2
            left = _Regression.around(effect, point, some).stepped(some.scale).residual
            return float(self.few.temper.value_of(mixture, energy_of(left, louder), louder).sum())

        return sorted(self.scans[effect.key], key=value, reverse=True)

    def _settled(self, effect: Effect, point: _Point, some: Fit) -> float:
        """Return the log likelihood of the regression around a point with rows weighed as what it leaves says.

        It starts from the weights of the fit, and from equal ones: rows that are met weigh far more than those that are
        missed, and would hide what explains the latter.
        """
        noise, found = self._noise(some) * point.loudness**2, []
        alike = torch.maximum(some.residual.square().mean((0, 1)).sqrt(), noise.sqrt()).expand_as(some.scale)
        for scale in (some.scale, alike):
            regression = _Regression.around(effect, point, some)
            for _ in range(_REWEIGHED):
                regression = regression.stepped(scale)
                left = energy_of(regression.residual, noise)
                mixture = self.few.temper.mixture(left, noise)
                scale = self.few.temper.weight_of(mixture, left, noise).rsqrt()[:, None]
                found.append(float(self.few.temper.value_of(mixture, left, noise).sum()))
        return max(found)

    def _point(self, effect: Effect, values: dict[str, float], base: Tensor) -> _Point:
        if _is_beside(effect, self.nominal):
            return self._load_at(effect, values)
        kept = tuple(f for f in self.nominal.known if f.effect.key != effect.key)
        simulator = self.nominal.with_effects((*kept, FittedEffect(effect, values)))
        residual = self.few.residual(simulator)
        columns = effect_jacobian(simulator, effect, self.few, residual)
        return _Point(values, base - residual, columns, self.few.loudness(simulator))

    def _load_at(self, effect: WrenchEffect, values: dict[str, float]) -> _Point:
        """Return what a load does at one point of its scan: nothing else has to be evaluated anew."""
        taken, columns = self._load(effect, values), []
        for parameter in effect.parameters:
            step = difference_of(values[parameter.name], parameter, self.problem.sizes)
            moved = self._load(effect, {**values, parameter.name: values[parameter.name] + step})
            columns.append((moved - taken) / step)
        return _Point(values, taken, torch.stack(columns, dim=-1), torch.ones_like(self.few.noise))

    def _load(self, effect: WrenchEffect, values: dict[str, float]) -> Tensor:
        """Return what a load takes off the residual, (blocks, rows, channels)."""
        wrench = effect.wrench(self._inner, values, self.nominal.constants())
        series = acting_series(self.nominal, wrench, self.few.blocks, self._inner)
        return windows_of(series, self.few.functions) * self._weights

    @cached_property
    def _inner(self) -> dict[str, Tensor]:
        return with_derived(self.nominal, self.few.inside(self.nominal))

    @cached_property
    def _weights(self) -> Tensor:
        return row_weights(self.nominal, self._inner, self.few.blocks, self.few.functions)


@dataclass(frozen=True)
class _Regression:
    """A fit and one more effect, with what they leave taken as linear in all parameters.

    Attributes:
        residual: (blocks, rows, channels).
        jacobian: (blocks, rows, channels, parameters).
        values: of the parameters, (parameters,).
        low: their lower bounds.
        high: their upper bounds.
    """

    residual: Tensor
    jacobian: Tensor
    values: Tensor
    low: Tensor
    high: Tensor

    @classmethod
    def around(cls, effect: Effect, point: _Point, current: Fit) -> "_Regression":
        """Begin with an effect at a point of its scan beside a fit."""
        low, high = bounds_of(current.simulator)
        own = effect.parameters
        return cls(
            current.residual - point.taken,
            torch.cat([current.jacobian, point.columns], dim=-1),
            torch.cat([current.values, low.new_tensor(list(point.values.values()))]),
            torch.cat([low, low.new_tensor([parameter.low for parameter in own])]),
            torch.cat([high, high.new_tensor([parameter.high for parameter in own])]),
        )

    def stepped(self, scale: Tensor) -> "_Regression":
        """Take one Newton step within the bounds, with rows of these standard deviations."""
        change, _ = bounded_newton_step(self.jacobian, self.residual, scale, self.values, self.low, self.high)
        values = (self.values + change).minimum(self.high).maximum(self.low)
        left = self.residual - self.jacobian @ (values - self.values)
        return replace(self, residual=left, values=values)


def _is_beside(effect: Effect, simulator: Simulator) -> TypeGuard[WrenchEffect]:
    """Whether an effect is a force beside all others: no dry friction answers it, and no actuator."""
    plain = isinstance(effect, WrenchEffect) and not isinstance(effect, ActuatorEffect | DryFriction)
    rubbed = any(f.effect.acts_on == effect.acts_on for f in simulator.of_type(DryFriction))
    return plain and effect.acts_on != "actuator" and not rubbed


def some_of(problem: Problem) -> tuple[Problem, Tensor]:
    """Return a problem with a part of its blocks, drawn evenly, and the places of those."""
    part = torch.linspace(0, len(problem.blocks) - 1, min(_SCANNED, len(problem.blocks))).round().long()
    return replace(problem, blocks=problem.blocks.take(part), cluster=problem.cluster[part]), part
