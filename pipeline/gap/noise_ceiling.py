"""The most that the noise of rows can be: what all linear laws of the catalogue leave together.

A fifth difference takes motion that is fast for its samples, and forces that jump, for noise. A regression on every
law that is linear in its parameters knows such motion, and leaves the noise and more.
"""

from collections.abc import Sequence

import torch
from torch import Tensor

from simgap.effects import Effect
from simgap.gap.fit import Problem
from simgap.simulation import FittedEffect, Simulator

_ROUNDING = 1e-10
"""Of the greatest singular value of the columns: less is no direction of its own."""


def noise_ceiling(nominal: Simulator, problem: Problem, effects: Sequence[Effect]) -> Tensor:
    """Return the standard deviation of what a regression on all linear laws leaves of rows, (channels,).

    Args:
        nominal: simulator whose residual is explained.
        problem: the fitted rows.
        effects: of the catalogue.
    """
    residual = problem.residual(nominal).flatten(0, 1)
    found = (problem.regressors(_beside(nominal, effect), effect) for effect in effects)
    columns = [each.flatten(0, 1) for each in found if each is not None]
    if not columns:
        return residual.square().mean(0).sqrt()
    laws = torch.cat(columns, dim=-1)
    return torch.stack([_left(residual[:, place], laws[:, place]) for place in range(residual.shape[1])])


def _beside(nominal: Simulator, effect: Effect) -> Simulator:
    """Return the nominal simulator with an effect that does nothing yet: signals are derived for it."""
    known = (fitted for fitted in nominal.known if fitted.effect.key != effect.key)
    return nominal.with_effects((*known, FittedEffect(effect, effect.neutral())))


def _left(residual: Tensor, laws: Tensor) -> Tensor:
    """Return the standard deviation that a regression of rows (rows,) on laws (rows, laws) leaves."""
    acting = laws[:, laws.abs().amax(0) > 0.0]
    acting = acting / acting.square().mean(0).sqrt()
    directions, sizes, _ = torch.linalg.svd(acting, full_matrices=False)
    directions = directions[:, sizes > _ROUNDING * sizes[:1].sum()]
    freedom = len(residual) - directions.shape[1]
    if freedom < 1:
        return residual.square().mean().sqrt()
    left = residual - directions @ (directions.T @ residual)
    return (left.square().sum() / freedom).sqrt()
