"""Gauss–Newton fit of effect parameters to a recording, with cluster-robust standard errors."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.effects import Effect, Parameter
from simgap.equations.problem import Problem
from simgap.simulation import FittedEffect, Simulator

_FIT_STEPS = 12
_DIFFERENCE = 1e-4


@dataclass(frozen=True)
class Fit:
    """A fitted simulator with its residual, Jacobian and covariance.

    Attributes:
        simulator: with the fitted values and their standard errors.
        residual: (blocks, rows, channels).
        jacobian: of the prediction in the parameters, (blocks, rows, channels, parameters).
        scale: standard deviation that residuals are weighed with, see `Problem.weigh`.
        covariance: of the parameters, robust to correlation inside clusters, (parameters, parameters).
    """

    simulator: Simulator
    residual: Tensor
    jacobian: Tensor
    scale: Tensor
    covariance: Tensor

    @property
    def values(self) -> Tensor:
        """The parameters of the free effects in order, (parameters,)."""
        return values_of(self.simulator)


def parameters_of(simulator: Simulator) -> list[Parameter]:
    """Return the parameters of the free effects in the order of a fit's columns."""
    return [parameter for fitted in simulator.free for parameter in fitted.effect.parameters]


def columns_of(fit: Fit, effect: Effect) -> list[int]:
    """Return the columns of a fit that belong to one effect."""
    owners = [f.effect.key for f in fit.simulator.free for _ in f.effect.parameters]
    return [column for column, owner in enumerate(owners) if owner == effect.key]


def channels_of(fit: Fit, effect: Effect) -> list[int]:
    """Return the channels that an effect of a fit acts on."""
    touched = fit.jacobian[..., columns_of(fit, effect)].abs().amax((0, 1, 3)) > 0
    return [index for index, hit in enumerate(touched.tolist()) if hit]


def excess_of(fit: Fit, noise: Tensor) -> Tensor:
    """Return the energy that a fit leaves in each channel over the noise's, (channels,)."""
    return fit.residual.square().mean((0, 1)) / noise.square()


def with_values(simulator: Simulator, values: Tensor) -> Simulator:
    """Return the simulator with the parameters of its free effects replaced, in order."""
    remaining = values.tolist()
    effects = list(simulator.known)
    for fitted in simulator.free:
        names = [parameter.name for parameter in fitted.effect.parameters]
        effects.append(FittedEffect(fitted.effect, dict(zip(names, remaining, strict=False))))
        remaining = remaining[len(names) :]
    return simulator.with_effects(tuple(effects))


def fit(simulator: Simulator, problem: Problem, most_steps: int = _FIT_STEPS) -> Fit:
    """Fit all parameters together by Gauss–Newton steps from the values that the simulator has.

    Rows are weighed as the problem says, anew at every step. Bounds are respected by clipping.

    Args:
        simulator: with values to start from.
        problem: what is fitted.
        most_steps: after which the fit ends wherever it is.
    """
    low, high = bounds_of(simulator)
    simulator = with_values(simulator, values_of(simulator).clamp(low, high))
    residual = problem.residual(simulator)
    jacobian, (scale, _) = jacobian_of(simulator, problem, residual), problem.weigh(residual, simulator)
    for _ in range(most_steps):
        values = values_of(simulator)
        change, promised = bounded_newton_step(jacobian, residual, scale, values, low, high)
        if promised < problem.least_gain(residual):
            break
        values, rows = line_search(simulator, problem, values, change, residual, scale)
        if rows is residual:
            break
        simulator, residual = with_values(simulator, values), rows
        jacobian, (scale, _) = jacobian_of(simulator, problem, residual), problem.weigh(residual, simulator)
    return finished(simulator, residual, jacobian, scale, problem)


def finished(
    simulator: Simulator, residual: Tensor, jacobian: Tensor, scale: Tensor, problem: Problem
) -> Fit:
    """Return the fit that a simulator with fitted values stands for.

    A value that rests on a bound has no standard error, and those of the others are what they are beside it: on the
    bound it moves no more, however little the recording says of it.
    """
    values, (low, high) = values_of(simulator), bounds_of(simulator)
    free = torch.nonzero((values > low) & (values < high)).squeeze(1)
    covariance = values.new_zeros(len(values), len(values))
    if len(free):
        own = clustered_covariance(jacobian[..., free], residual, scale, problem.cluster)
        covariance[free[:, None], free] = own
    return Fit(with_errors(simulator, covariance), residual, jacobian, scale, covariance)


def values_of(simulator: Simulator) -> Tensor:
    """Return the parameters of the free effects in order, (parameters,)."""
    return torch.tensor([v for f in simulator.free for v in f.values.values()], dtype=torch.float64)


def bounds_of(simulator: Simulator) -> tuple[Tensor, Tensor]:
    """Return the lower and the upper bound of each parameter."""
    parameters = parameters_of(simulator)
    low = torch.tensor([parameter.low for parameter in parameters], dtype=torch.float64)
    return low, torch.tensor([parameter.high for parameter in parameters], dtype=torch.float64)


def jacobian_of(simulator: Simulator, problem: Problem, residual: Tensor) -> Tensor:
    """Return how the prediction changes with each parameter: (blocks, rows, channels, parameters)."""
    parts = [effect_jacobian(simulator, fitted.effect, problem, residual) for fitted in simulator.free]
    return torch.cat(parts, dim=-1) if parts else residual.new_zeros((*residual.shape, 0))


def effect_jacobian(simulator: Simulator, effect: Effect, problem: Problem, residual: Tensor) -> Tensor:
    """Return the columns of one effect, exactly where it is linear, by a finite difference elsewhere."""
    exact = problem.regressors(simulator, effect)
    if exact is not None:
        return exact
    if problem.is_sum_with(simulator, effect):
        values = next(f.values for f in simulator.free if f.effect.key == effect.key)
        return summand_of(effect, values, simulator, problem)[1]
    owners = [(f.effect.key, parameter) for f in simulator.free for parameter in f.effect.parameters]
    columns = [
        _difference(simulator, problem, residual, column, parameter)
        for column, (key, parameter) in enumerate(owners)
        if key == effect.key
    ]
    return torch.stack(columns, dim=-1)


def summand_of(
    effect: Effect, values: Mapping[str, float], base: Simulator, problem: Problem
) -> tuple[Tensor, Tensor]:
    """Return what an effect takes off the rows to which it only adds, and its columns by finite differences.

    Args:
        effect: only adds to the rows of the base, see `Problem.is_sum_with`.
        values: of its parameters.
        base: what else acts.
        problem: the rows.

    Returns:
        (blocks, rows, channels) and (blocks, rows, channels, parameters).
    """
    steps = {p.name: _step(float(values[p.name]), p, problem) for p in effect.parameters}
    moved = [{**values, name: values[name] + step} for name, step in steps.items()]
    series = problem.summands(base, effect, [values, *moved])
    taken = series[..., 0]
    return taken, (series[..., 1:] - taken[..., None]) / torch.tensor(list(steps.values()), dtype=taken.dtype)


def _difference(
    simulator: Simulator, problem: Problem, residual: Tensor, column: int, parameter: Parameter
) -> Tensor:
    values = values_of(simulator)
    step = _step(float(values[column]), parameter, problem)
    values[column] += step
    rows = problem.residual(with_values(simulator, values))
    return -(rows - residual) / step


def _step(value: float, parameter: Parameter, problem: Problem) -> float:
    """Return the step of a finite difference, in the parameter's unit, that stays within its bounds."""
    usual = parameter.default * parameter.size_in(problem.sizes)
    step = _DIFFERENCE * max(abs(value), abs(usual))
    return -step if value + step > parameter.high else step


def bounded_newton_step(
    jacobian: Tensor, residual: Tensor, scale: Tensor, values: Tensor, low: Tensor, high: Tensor
) -> tuple[Tensor, float]:
    """Solve the weighted normal equations; a parameter on its bound that wants to leave it stays.

    Also return by how much the step promises to lower the weighted cost.
    """
    weighted = jacobian / scale[..., None]
    gram = torch.einsum("brcp,brcq->pq", weighted, weighted)
    gradient = torch.einsum("brcp,brc->p", weighted, residual / scale)
    free = ~(((values <= low) & (gradient < 0)) | ((values >= high) & (gradient > 0)))
    change = torch.zeros_like(values)
    if free.any():
        size = gram.diagonal().clamp_min(1e-30).sqrt()
        normal = (gram / size / size[:, None])[free][:, free]
        normal = normal + 1e-10 * torch.eye(len(normal), dtype=normal.dtype)
        change[free] = torch.linalg.solve(normal, (gradient / size)[free]) / size[free]
    return change, float(gradient @ change)


def line_search(
    simulator: Simulator, problem: Problem, values: Tensor, change: Tensor, residual: Tensor, scale: Tensor
) -> tuple[Tensor, Tensor]:
    """Take the longest step of 1, ½, ¼, … that lowers the weighted cost; return the values and their residual."""
    cost = (residual / scale).square().sum()
    low, high = bounds_of(simulator)
    for halving in range(6):
        tried = (values + change * 0.5**halving).clamp(low, high)
        rows = problem.residual(with_values(simulator, tried))
        if (rows / scale).square().sum() < cost:
            return tried, rows
    return values, residual


def inverse_of(information: Tensor) -> Tensor:
    """Return the pseudo-inverse of information or covariance, the same in whatever units the parameters are.

    A rotor's inertia and a drag coefficient differ by eight decades: without a common size, what is known of the one
    passes for rounding of the other.
    """
    size = information.diagonal().clamp_min(1e-300).sqrt()
    return torch.linalg.pinv(information / size / size[:, None], hermitian=True) / size / size[:, None]


def clustered_covariance(jacobian: Tensor, residual: Tensor, scale: Tensor, cluster: Tensor) -> Tensor:
    """Return the sandwich covariance of the parameters with residuals correlated inside clusters.

    Source: Liang & Zeger 1986, Longitudinal data analysis using generalized linear models (Biometrika 73), with the
    small-sample factor G/(G − 1).
    """
    weighted = jacobian / scale[..., None]
    gram = torch.einsum("brcp,brcq->pq", weighted, weighted)
    score = torch.einsum("brcp,brc->bp", weighted, residual / scale)
    groups = int(cluster.max()) + 1
    summed = score.new_zeros((groups, score.shape[1])).index_add(0, cluster, score)
    bread = inverse_of(gram)
    return bread @ (summed.T @ summed) @ bread * (groups / max(groups - 1, 1))


def with_errors(simulator: Simulator, covariance: Tensor) -> Simulator:
    """Return the simulator with the standard errors of its parameters."""
    errors = covariance.diagonal().clamp_min(0.0).sqrt().tolist()
    effects = list(simulator.known)
    for fitted in simulator.free:
        names = list(fitted.values)
        effects.append(FittedEffect(fitted.effect, fitted.values, dict(zip(names, errors, strict=False))))
        errors = errors[len(names) :]
    return simulator.with_effects(tuple(effects))
