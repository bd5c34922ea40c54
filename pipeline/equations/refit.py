"""A fit with one effect more or one less, without a full refit of the others."""

from collections.abc import Sequence

import torch
from torch import Tensor

from simgap.effects import Effect
from simgap.equations.fit import (
    Fit,
    bounded_newton_step,
    bounds_of,
    columns_of,
    effect_jacobian,
    finished,
    fit,
    line_search,
    values_of,
    with_values,
)
from simgap.equations.problem import Problem
from simgap.equations.starts import Starts, some_of
from simgap.simulation import FittedEffect, Simulator

_SLOPE_STEPS = 3  # Newton steps with kept slopes
_MOST_STEPS = 8  # Newton steps with new slopes
_PROGRESS = 0.05  # of the total decrease of the cost, which the last step must give for another to follow
_FOLLOWED = 3  # starts that are tried beside the fit, and followed where the best one ends on a bound


def extend(current: Fit, effect: Effect, problem: Problem, starts: Starts | None = None) -> Fit:
    """Add an effect to a fit: its own columns are computed, those of the others kept.

    An effect that is known already is set free. Channels are weighed anew at every step. The winner of a round is
    fitted again in full.

    Args:
        current: without the effect.
        effect: to be added.
        problem: what is fitted.
        starts: where fits of the effect may begin; None: scanned beside the fit itself. The most promising one is
            followed, some more where it leads to a bound or is a limit, and each where a kink lies between them.
    """
    known = _fitted_values(current, effect)
    values = [known] if known else (starts or Starts(current.simulator, problem)).of(effect)
    if effect.kinked:
        return _best(
            [_extended(current, effect, problem, start) for start in _tried(current, effect, values)], problem
        )
    if len(values) > 1:
        values = (starts or Starts(current.simulator, problem)).ranked(effect, current)
    tried = _tried(current, effect, values[:_FOLLOWED])
    tried = _most_promising_first(tried, effect, current, problem)
    found = _extended(current, effect, problem, tried[0])
    if not _rests_on_a_bound(found, effect) and not _is_limit(effect):
        return found
    others = [_extended(current, effect, problem, each) for each in (*tried[1:], _freed(found, effect))]
    return _best([found, *others], problem)


def _tried(current: Fit, effect: Effect, values: Sequence[dict[str, float]]) -> list[Simulator]:
    """Return the simulators from which an effect is fitted."""
    kept = tuple(f for f in current.simulator.effects if f.effect.key != effect.key)
    return [current.simulator.with_effects((*kept, FittedEffect(effect, each))) for each in values]


def _fitted_values(current: Fit, effect: Effect) -> dict[str, float] | None:
    return next((dict(f.values) for f in current.simulator.known if f.effect.key == effect.key), None)


def _residual_at(start: Simulator, current: Fit, effect: Effect, problem: Problem) -> Tensor:
    """Return what a start leaves; where a linear effect changes nothing yet, nothing has to be evaluated.

    Others may change something where their own parameters do not, as clocks that deviate from run to run do.
    """
    unchanged = _fitted_values(current, effect) or effect.neutral()
    rests = start.is_linear_in(effect) and start.effects[-1].values == unchanged
    return current.residual if rests else problem.residual(start)


def _best(fits: Sequence[Fit], problem: Problem) -> Fit:
    return min(fits, key=lambda each: problem.cost(each.residual, each.simulator))


def _rests_on_a_bound(found: Fit, effect: Effect) -> bool:
    """Whether one of several values lies on a bound: it may have made up for others that were still far off."""
    linear = found.simulator.is_linear_in(effect)
    return len(effect.parameters) > 1 and not linear and bool(_on_bounds(found, effect))


def _is_limit(effect: Effect) -> bool:
    """Whether an effect has no slope where its limit is not reached."""
    return effect.parameters[0].is_limit


def _on_bounds(found: Fit, effect: Effect) -> dict[str, float]:
    """Return the usual values of those of an effect's parameters that lie on a bound."""
    values = found.simulator.effects[-1].values
    return {p.name: p.default for p in effect.parameters if values[p.name] in (p.low, p.high)}


def _freed(found: Fit, effect: Effect) -> Simulator:
    """Return a fitted simulator with those of the last effect's values that lie on a bound put back."""
    *others, last = found.simulator.effects
    freed = FittedEffect(effect, {**last.values, **_on_bounds(found, effect)})
    return found.simulator.with_effects((*others, freed))


def _extended(current: Fit, effect: Effect, problem: Problem, start: Simulator) -> Fit:
    simulator, residual = start, _residual_at(start, current, effect, problem)
    scale, cost = problem.weigh(residual, simulator)
    costs, linear = [cost], start.is_linear_in(effect)
    added = effect_jacobian(simulator, effect, problem, residual)
    for step in range(_MOST_STEPS):
        if step > 0 and not linear:
            added = effect_jacobian(simulator, effect, problem, residual)
        jacobian = torch.cat([current.jacobian, added], dim=-1)
        if step > 0:
            simulator, residual = _stepped(simulator, residual, jacobian, problem, scale)
        else:
            simulator, residual = _first_step(simulator, residual, jacobian, problem, scale)
        scale, cost = problem.weigh(residual, simulator)
        costs.append(cost)
        if costs[-2] - costs[-1] <= _PROGRESS * (costs[0] - costs[-1]):
            break
    return _finished(simulator, residual, jacobian, problem, scale)


def remove(current: Fit, effect: Effect, problem: Problem, known: FittedEffect | None = None) -> Fit:
    """Take an effect out of a fit, or put it back to what was known of it, and leave the others as they are."""
    simulator = _without(current, effect, known)
    mine = columns_of(current, effect)
    others = [column for column in range(current.jacobian.shape[-1]) if column not in mine]
    return _finished(simulator, problem.residual(simulator), current.jacobian[..., others], problem)


def shrink(current: Fit, effect: Effect, problem: Problem, known: FittedEffect | None = None) -> Fit:
    """Take an effect out of a fit, or put it back to what was known of it.

    The others move by a few Newton steps with the slopes that they had beside it; where those lead nowhere, they are
    fitted again.
    """
    simulator = _without(current, effect, known)
    mine = columns_of(current, effect)
    others = [column for column in range(current.jacobian.shape[-1]) if column not in mine]
    return _eased(simulator, current.jacobian[..., others], problem) or fit(simulator, problem)


def _without(current: Fit, effect: Effect, known: FittedEffect | None) -> Simulator:
    kept = tuple(f for f in current.simulator.effects if f.effect.key != effect.key)
    return current.simulator.with_effects((known, *kept) if known else kept)


def _eased(simulator: Simulator, jacobian: Tensor, problem: Problem) -> Fit | None:
    """Move all parameters by a few Newton steps with slopes from nearby; None where the first leads nowhere."""
    residual = problem.residual(simulator)
    for step in range(_SLOPE_STEPS if jacobian.shape[-1] else 0):
        scale, _ = problem.weigh(residual, simulator)
        moved, rows = _stepped(simulator, residual, jacobian, problem, scale)
        if moved is simulator:
            if step == 0:
                return None
            break
        simulator, residual = moved, rows
    return _finished(simulator, residual, jacobian, problem)


def _most_promising_first(
    tried: list[Simulator], effect: Effect, current: Fit, problem: Problem
) -> list[Simulator]:
    """Return starting points in the order of what one Newton step from each promises on some of the blocks."""
    if len(tried) == 1:
        return tried
    few, part = some_of(problem)
    return sorted(tried, key=lambda each: _promise(each, effect, current, few, part))


def _promise(simulator: Simulator, effect: Effect, current: Fit, few: Problem, part: Tensor) -> float:
    """Return the weighted cost that one Newton step from a starting point would leave on some of the blocks."""
    residual = few.residual(simulator)
    added = effect_jacobian(simulator, effect, few, residual)
    jacobian = torch.cat([current.jacobian[part], added], dim=-1)
    low, high = bounds_of(simulator)
    values = values_of(simulator)
    change, _ = bounded_newton_step(jacobian, residual, current.scale[part], values, low, high)
    left = residual - jacobian @ change.minimum(high - values).maximum(low - values)
    return few.cost(left, simulator)


def _stepped(
    simulator: Simulator, residual: Tensor, jacobian: Tensor, problem: Problem, scale: Tensor
) -> tuple[Simulator, Tensor]:
    low, high = bounds_of(simulator)
    values = values_of(simulator)
    change, _ = bounded_newton_step(jacobian, residual, scale, values, low, high)
    after, rows = line_search(simulator, problem, values, change, residual, scale)
    return (simulator, residual) if rows is residual else (with_values(simulator, after), rows)


def _first_step(
    simulator: Simulator, residual: Tensor, jacobian: Tensor, problem: Problem, scale: Tensor
) -> tuple[Simulator, Tensor]:
    """Take the better one of two steps: with all rows weighed alike, and as they are weighed now.

    Rows that are met weigh far more than rows that are missed, so that those of an axis at rest hide what moves it. The
    likelihood then has a maximum at which an effect does nothing.
    """
    alike = torch.maximum(residual.square().mean((0, 1)).sqrt(), problem.noise).expand_as(scale)
    steps = [_stepped(simulator, residual, jacobian, problem, each) for each in (scale, alike)]
    return min(steps, key=lambda step: problem.cost(step[1], step[0]))


def _finished(
    simulator: Simulator, residual: Tensor, jacobian: Tensor, problem: Problem, scale: Tensor | None = None
) -> Fit:
    scale = problem.weigh(residual, simulator)[0] if scale is None else scale
    return finished(simulator, residual, jacobian, scale, problem)
