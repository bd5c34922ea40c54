"""A fit with one effect more or one less, without fitting the others from scratch."""

from collections.abc import Sequence
from dataclasses import replace

import torch
from torch import Tensor

from pipeline.effects import Effect, WrenchEffect
from pipeline.gap.fit import (
    Fit,
    Problem,
    bounded_newton_step,
    bounds_of,
    channel_scale,
    clustered_covariance,
    columns_of,
    effect_jacobian,
    fit,
    values_of,
    with_errors,
    with_values,
)
from pipeline.simulation import FittedEffect, Simulator

_STEPS = 3
_SCANNED = 60  # blocks that a scan of starting points looks at


def extend(
    current: Fit, effect: Effect, problem: Problem, starts: Sequence[dict[str, float]] | None = None
) -> Fit:
    """Add an effect to a fit: its own columns are computed, those of the others kept.

    An effect that is known already is set free. A linear effect needs no evaluation of the simulator at all, any other
    a handful. The winner of a round is fitted again in full.

    Args:
        current: without the effect.
        effect: to be added.
        problem: what is fitted.
        starts: values from which to start, the most promising of which is taken; None: the effect's own. Where a kink
            lies between them, each is followed to the end.
    """
    if starts is None:
        starts = effect.starts()
    if not effect.kinked:
        found = _extended(current, effect, problem, starts)
        freed = _freed(found, effect)
        return _better([found, _extended(current, effect, problem, [freed])], current) if freed else found
    return _better([_extended(current, effect, problem, [start]) for start in starts], current)


def _better(fits: Sequence[Fit], current: Fit) -> Fit:
    return min(fits, key=lambda each: float((each.residual / current.scale).square().sum()))


def _freed(found: Fit, effect: Effect) -> dict[str, float] | None:
    """Return an effect's values with those on a bound put back, where there are others; None where none rests there.

    What lies on a bound may have made up for others that were still far off.
    """
    values = found.simulator.effects[-1].values
    usual = {parameter.name: parameter.default for parameter in effect.parameters}
    bounds = {parameter.name: (parameter.low, parameter.high) for parameter in effect.parameters}
    resting = [name for name, value in values.items() if value in bounds[name]]
    if not resting or len(resting) == len(values) or _is_linear(effect):
        return None
    return {**values, **{name: usual[name] for name in resting}}


def _extended(current: Fit, effect: Effect, problem: Problem, starts: Sequence[dict[str, float]]) -> Fit:
    simulator, residual = _start(current, effect, problem, starts)
    for _ in range(1 if _is_linear(effect) else _STEPS):
        added = effect_jacobian(simulator, effect, problem, residual)
        jacobian = torch.cat([current.jacobian, added], dim=-1)
        simulator, residual = _stepped(simulator, residual, jacobian, problem, _is_linear(effect))
    return _finished(simulator, residual, jacobian, problem)


def remove(current: Fit, effect: Effect, problem: Problem, known: FittedEffect | None = None) -> Fit:
    """Take an effect out of a fit, or put it back to what was known of it, and leave the others as they are."""
    simulator = _without(current, effect, known)
    mine = columns_of(current, effect)
    others = [column for column in range(current.jacobian.shape[-1]) if column not in mine]
    return _finished(simulator, problem.residual(simulator), current.jacobian[..., others], problem)


def shrink(current: Fit, effect: Effect, problem: Problem, known: FittedEffect | None = None) -> Fit:
    """Take an effect out of a fit, or put it back to what was known of it.

    The others move by one Newton step where the effect is linear, else by a few with the slopes that they had beside
    it; where those lead nowhere, they are fitted again.
    """
    simulator = _without(current, effect, known)
    mine = columns_of(current, effect)
    others = [column for column in range(current.jacobian.shape[-1]) if column not in mine]
    if not _is_linear(effect):
        return _eased(simulator, current.jacobian[..., others], problem) or fit(simulator, problem)
    rest = torch.tensor(list((known.values if known else effect.neutral()).values()), dtype=torch.float64)
    residual = current.residual + current.jacobian[..., mine] @ (current.values[mine] - rest)
    jacobian = current.jacobian[..., others]
    if others:
        simulator, residual = _stepped(simulator, residual, jacobian, problem, linear=True)
    return _finished(simulator, residual, jacobian, problem)


def _without(current: Fit, effect: Effect, known: FittedEffect | None) -> Simulator:
    kept = tuple(f for f in current.simulator.effects if f.effect.key != effect.key)
    return current.simulator.with_effects((known, *kept) if known else kept)


def _eased(simulator: Simulator, jacobian: Tensor, problem: Problem) -> Fit | None:
    """Move all parameters by a few Newton steps with slopes from nearby; None where the first leads nowhere."""
    residual = problem.residual(simulator)
    for step in range(_STEPS if jacobian.shape[-1] else 0):
        moved, rows = _stepped(simulator, residual, jacobian, problem, linear=False)
        if moved is simulator:
            if step == 0:
                return None
            break
        simulator, residual = moved, rows
    return _finished(simulator, residual, jacobian, problem)


def _is_linear(effect: Effect) -> bool:
    return isinstance(effect, WrenchEffect) and effect.linear


def _start(
    current: Fit, effect: Effect, problem: Problem, starts: Sequence[dict[str, float]]
) -> tuple[Simulator, Tensor]:
    """Return the simulator at the effect's most promising starting point, and its residual.

    A start is worth what one Newton step from it promises: many effects have a size that only a step can tell and a
    shape that only a scan can find. The scan looks at a part of the blocks, drawn evenly.
    """
    kept = tuple(f for f in current.simulator.effects if f.effect.key != effect.key)
    known = next((f for f in current.simulator.known if f.effect.key == effect.key), None)
    starts = [dict(known.values)] if known else starts
    simulators = [current.simulator.with_effects((*kept, FittedEffect(effect, values))) for values in starts]
    best = simulators[0]
    if len(simulators) > 1:
        part = torch.linspace(0, len(problem.blocks) - 1, min(_SCANNED, len(problem.blocks))).round().long()
        few = replace(problem, blocks=problem.blocks.take(part), cluster=problem.cluster[part])
        best = min(simulators, key=lambda tried: _promise(tried, effect, current, few, part))
    if best is simulators[0] and (known or starts[0] == effect.neutral()):
        return best, current.residual
    return best, problem.residual(best)


def _promise(simulator: Simulator, effect: Effect, current: Fit, few: Problem, part: Tensor) -> float:
    """Return the weighted cost that one Newton step from a starting point would leave on some of the blocks."""
    residual = few.residual(simulator)
    added = effect_jacobian(simulator, effect, few, residual)
    jacobian = torch.cat([current.jacobian[part], added], dim=-1)
    low, high = bounds_of(simulator)
    step = bounded_newton_step(jacobian, residual, current.scale, values_of(simulator), low, high)
    change = step[0].minimum(high - values_of(simulator)).maximum(low - values_of(simulator))
    return float(((residual - jacobian @ change) / current.scale).square().sum())


def _stepped(
    simulator: Simulator, residual: Tensor, jacobian: Tensor, problem: Problem, linear: bool
) -> tuple[Simulator, Tensor]:
    low, high = bounds_of(simulator)
    values, scale = values_of(simulator), channel_scale(residual, problem.noise)
    change, _ = bounded_newton_step(jacobian, residual, scale, values, low, high)
    after = (values + change).clamp(low, high)
    moved = with_values(simulator, after)
    if linear:
        return moved, residual - jacobian @ (after - values)
    rows = problem.residual(moved)
    worse = (rows / scale).square().sum() > (residual / scale).square().sum()
    return (simulator, residual) if worse else (moved, rows)


def _finished(simulator: Simulator, residual: Tensor, jacobian: Tensor, problem: Problem) -> Fit:
    scale = channel_scale(residual, problem.noise)
    covariance = clustered_covariance(jacobian, residual, scale, problem.cluster)
    return Fit(with_errors(simulator, covariance), residual, jacobian, scale, covariance)
