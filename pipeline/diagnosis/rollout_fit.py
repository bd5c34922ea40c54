"""Joint refit of all parameters through open-loop predictions, as the simulator will be used.

The weak form finds effects quickly, but noise in its regressors biases their values a little. An open-loop prediction
uses the noisy recording only for its initial state.
Source: Bock 1983, Recent advances in parameter identification techniques for ODE (multiple shooting, its segments here
started from recorded states).
"""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.diagnosis.horizon import state_noise
from simgap.effects import Effect
from simgap.equations.fit import (
    Fit,
    bounded_newton_step,
    bounds_of,
    finished,
    jacobian_of,
    line_search,
    parameters_of,
    values_of,
    with_values,
)
from simgap.equations.problem import Problem
from simgap.equations.scoring import cross_validated, folds_of, log_score
from simgap.simulation import FittedEffect, Simulator, replay
from simgap.simulation.motion import motion_of
from simgap.simulation.replay import substeps_for

_MOST_BLOCKS = 120
_COST_TOLERANCE = 1e-7  # of the cost of one error, which a step has to promise
_ENDS = 5  # instants at which predictions are compared
_FAR = 5.0  # standard errors by which a value may move
_BLUNTER = 2.0  # times the first standard error, which the new one may not exceed
_LEAST_MOVE = 0.05  # of a value, by which it may move in addition
_MOST_SLOPES, _MOST_STEPS = 6, 8  # of a fit, and steps with the same slopes


@dataclass(frozen=True)
class RolloutProblem(Problem):
    """A problem whose residual is the error of open-loop predictions.

    Attributes:
        recorded: states of the blocks, (blocks, steps + 1, n).
        substeps: integration steps between two samples.
    """

    recorded: Tensor | None = None
    substeps: int = 1

    def residual(self, simulator: Simulator) -> Tensor:
        """Return recorded less predicted states at a few instants, (blocks, instants, n)."""
        assert self.recorded is not None
        steps = self.recorded.shape[1] - 1
        predicted = replay(simulator, self.blocks, self.recorded[:, 0], steps, self.substeps)
        ends = torch.linspace(0, steps, _ENDS + 1).round().long()[1:]
        error = self.recorded[:, ends] - predicted[:, ends]
        return torch.nan_to_num(error, nan=1e6, posinf=1e6, neginf=-1e6).clamp(-1e6, 1e6)

    def weigh(self, residual: Tensor, simulator: Simulator | None = None) -> tuple[Tensor, float]:
        """Return the standard deviation of each signal's error, never below the noise, (n,), and the cost per error.

        It is the maximum-likelihood weight where variances are unknown.
        """
        variance = residual.square().mean((0, 1))
        scale = torch.maximum(variance.sqrt(), self.noise).clamp_min(1e-12)
        return scale, float((scale.log() + 0.5 * variance / scale.square()).sum())

    def least_gain(self, residual: Tensor) -> float:
        """Return the decrease of the weighted cost that is worth another step of a fit."""
        return _COST_TOLERANCE * residual.numel()

    def regressors(self, simulator: Simulator, effect: Effect) -> Tensor | None:
        """Return None: through a prediction no effect is linear."""
        return None

    def is_sum_with(self, simulator: Simulator, effect: Effect) -> bool:
        """Return False: what an effect adds moves what all others do."""
        return False


def refit_through_rollouts(found: Fit, problem: Problem, horizon: float, folds: int) -> tuple[Fit, bool]:
    """Refit every free parameter through predictions over a horizon.

    The new values are accepted if they predict left-out folds at least as well, if none is known much less well, and if
    each stays within the tolerance of the first fit. A parameter that no prediction depends on stays unchanged.

    Args:
        found: the fit of the equations of motion.
        problem: its blocks, windows and noise.
        horizon: of the predictions, s.
        folds: of the cross-validation.

    Returns:
        The fit of the equations of motion at the new values with their standard errors, and whether they were taken.
    """
    if not found.simulator.free:
        return found, False
    rollouts = rollout_problem(found.simulator, problem, horizon)
    before = rollouts.residual(found.simulator)
    refitted = fit_with_kept_slopes(found.simulator, rollouts)
    values, std = _merged(found, refitted)
    if not _better(refitted, before, rollouts, folds) or not _agree(found, values, std):
        return found, False
    simulator = _with(found.simulator, values, std)
    residual = problem.residual(simulator)
    jacobian = jacobian_of(simulator, problem, residual)
    return replace(found, simulator=simulator, residual=residual, jacobian=jacobian), True


def fit_with_kept_slopes(simulator: Simulator, problem: RolloutProblem) -> Fit:
    """Fit all parameters together by Gauss–Newton steps that keep their slopes while these serve.

    A new slope takes one prediction for each parameter, a step one. Near the minimum slopes hardly change. The last
    ones are those at the values that are returned.
    Source: Dennis & Schnabel 1983, Numerical methods for unconstrained optimization, §5.4 (the chord method).
    """
    low, high = bounds_of(simulator)
    values = values_of(simulator).clamp(low, high)
    residual = problem.residual(with_values(simulator, values))
    for _ in range(_MOST_SLOPES):
        before, jacobian = residual, jacobian_of(with_values(simulator, values), problem, residual)
        for _ in range(_MOST_STEPS):
            scale, _ = problem.weigh(residual)
            change, promised = bounded_newton_step(jacobian, residual, scale, values, low, high)
            if promised < problem.least_gain(residual):
                break
            values, rows = line_search(simulator, problem, values, change, residual, scale)
            if rows is residual:
                break
            residual = rows
        if residual is before:
            break
    else:
        jacobian = jacobian_of(with_values(simulator, values), problem, residual)
    return finished(with_values(simulator, values), residual, jacobian, problem.weigh(residual)[0], problem)


def rollout_problem(simulator: Simulator, problem: Problem, horizon: float) -> RolloutProblem:
    """Return the predictions over a horizon, s, from some of the blocks of a problem in which all effects act."""
    present = problem.present
    drawn = torch.linspace(0, len(present) - 1, min(_MOST_BLOCKS, len(present))).round().long()
    part = present[drawn]
    blocks = problem.blocks.take(part)
    steps = max(min(round(horizon / blocks.time_step), blocks.samples - 1), 1)
    inner = {name: blocks.inner(series)[:, : steps + 1] for name, series in blocks.signals.items()}
    noise = state_noise(blocks, simulator).clamp_min(1e-9)
    substeps = substeps_for(simulator, blocks, steps, noise)
    recorded = motion_of(simulator.platform, blocks.signals).pack(inner)
    cluster = torch.unique(problem.cluster[part], return_inverse=True)[1]
    return RolloutProblem(
        blocks,
        problem.functions,
        noise,
        torch.zeros_like(noise),
        cluster,
        problem.temper,
        recorded=recorded,
        substeps=substeps,
    )


def _merged(found: Fit, refitted: Fit) -> tuple[Tensor, Tensor]:
    """Return values and standard errors, those of the equations of motion where no prediction depends on them."""
    seen = refitted.jacobian.abs().amax((0, 1, 2)) > 0
    errors = [fit.covariance.diagonal().clamp_min(0.0).sqrt() for fit in (refitted, found)]
    return torch.where(seen, refitted.values, found.values), torch.where(seen, errors[0], errors[1])


def _better(refitted: Fit, before: Tensor, rollouts: RolloutProblem, folds: int) -> bool:
    after = cross_validated(refitted, folds_of(rollouts.blocks, folds))
    scores = [float(log_score(residual, refitted.scale).sum()) for residual in (after, before)]
    return scores[0] >= scores[1]


def _agree(found: Fit, values: Tensor, std: Tensor) -> bool:
    weak = found.covariance.diagonal().clamp_min(0.0).sqrt()
    neutral = torch.tensor([p.neutral for p in parameters_of(found.simulator)], dtype=torch.float64)
    allowed = _FAR * (weak.square() + std.square()).sqrt() + _LEAST_MOVE * found.values.abs()
    blunter = std > _BLUNTER * weak
    vanished = (values == neutral) & (found.values != neutral)
    return bool(((values - found.values).abs() <= allowed).all()) and not bool((vanished | blunter).any())


def _with(simulator: Simulator, values: Tensor, std: Tensor) -> Simulator:
    numbers, errors = iter(values.tolist()), iter(std.tolist())
    effects = [
        FittedEffect(
            fitted.effect,
            {parameter.name: next(numbers) for parameter in fitted.effect.parameters},
            {parameter.name: next(errors) for parameter in fitted.effect.parameters},
        )
        for fitted in simulator.free
    ]
    return simulator.with_effects((*simulator.known, *effects))
