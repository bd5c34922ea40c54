"""The most that the noise of rows can be: what all linear laws of the catalogue leave together.

A fifth difference takes motion that is fast for its samples, and forces that jump, for noise. A regression on every
law that is linear in its parameters knows such motion, and leaves the noise and more. What it explains with signals
that are noisy themselves is partly their own noise, as of a motor at rest: that is given back.
"""

from collections.abc import Sequence
from dataclasses import replace

import torch
from torch import Tensor

from simgap.effects import Effect, WrenchEffect
from simgap.equations.problem import Problem, law_series
from simgap.equations.residuals import channel_series
from simgap.equations.sample_noise import sample_noise
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
    columns, series = [], []
    for effect in effects:
        beside = _beside(nominal, effect)
        found = problem.regressors(beside, effect)
        if found is not None:
            assert isinstance(effect, WrenchEffect)
            columns.append(found.flatten(0, 1))
            series.append(law_series(beside, effect, replace(problem.blocks, held=False)))
    if not columns:
        return residual.square().mean(0).sqrt()
    laws, acting = torch.cat(columns, dim=-1), torch.cat(series, dim=-1)
    channels = zip(residual.unbind(1), laws.unbind(1), strict=True)
    left, sizes = map(torch.stack, zip(*(_explained(*channel) for channel in channels), strict=True))
    taken = _noise_taken(nominal, problem, torch.einsum("bscp,cp->bsc", acting, sizes))
    return (left + taken).sqrt()


def _beside(nominal: Simulator, effect: Effect) -> Simulator:
    """Return the nominal simulator with an effect that does nothing yet: signals are derived for it."""
    known = (fitted for fitted in nominal.known if fitted.effect.key != effect.key)
    return nominal.with_effects((*known, FittedEffect(effect, effect.neutral())))


def _explained(residual: Tensor, laws: Tensor) -> tuple[Tensor, Tensor]:
    """Return the variance that a regression of rows (rows,) on laws (rows, laws) leaves, and their sizes (laws,)."""
    size = laws.square().mean(0).sqrt()
    acting = size > 0.0
    directions, sizes, combined = torch.linalg.svd(laws[:, acting] / size[acting], full_matrices=False)
    known = sizes > _ROUNDING * sizes[:1].sum()
    directions, sizes, combined = directions[:, known], sizes[known], combined[known]
    coefficients = torch.zeros_like(size)
    freedom = len(residual) - directions.shape[1]
    if freedom < 1:
        return residual.square().mean(), coefficients
    along = directions.T @ residual
    coefficients[acting] = combined.T @ (along / sizes) / size[acting]
    return (residual - directions @ along).square().sum() / freedom, coefficients


def _noise_taken(nominal: Simulator, problem: Problem, added: Tensor) -> Tensor:
    """Return the variance of rows that noise of the predicted side gives, and no more with the laws, (channels,).

    Args:
        nominal: simulator that the laws are added to.
        problem: the fitted rows.
        added: what the laws do, (blocks, samples, channels).
    """
    blocks = problem.blocks
    gain = problem.functions.weights.square().sum(1).mean()
    taken = []
    for place, series in enumerate(channel_series(nominal, replace(blocks, held=False))):
        before, after = (
            sample_noise(each, blocks.noise_kept)
            for each in (series.predicted, series.predicted + added[..., place])
        )
        taken.append(gain * (before - after).clamp_min(0.0))
    return torch.stack(taken)
