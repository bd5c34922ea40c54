"""Gaussian processes, one for each residual, fitted together.

A residual is a function of the state, of which every flight shows the same, and noise. Samples of one flight follow one
another, so that a part of what its drift happened to be passes for what the state makes of it, and that with certainty.
How large that part is, and for how long it lasts, shows in flights that are foretold from the others (`wander`).

Rasmussen & Williams 2006, "Gaussian Processes for Machine Learning", eqs. 2.23–2.24 (posterior), 5.8 (marginal
likelihood); squared exponential kernel with a length scale for every feature, and noise.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import gpytorch
import torch
from torch import Tensor

from simgap.policies.residual.wander import Course, Wander, wander_of
from simgap.recordings.excerpt import evenly

# Of scaled features and outputs: beyond these a process only looks more certain than a thousand samples can be, and
# takes what was never flown for worse than all that was.
_LENGTHS, _VARIANCES, _NOISES = (0.1, 30.0), (0.01, 1.0), (1e-3, 1.5)
_START_VALUES = {"lengths": 3.0, "variance": 0.5, "noise": 0.1}
_JITTER = 1e-6  # of a process's variance, for the factorisation


@dataclass(frozen=True)
class GaussianProcesses:
    """Processes over the same inputs, all in their standard deviations and about their means.

    Attributes:
        inputs: (samples, features), scaled.
        outputs: (processes, samples), scaled.
        lengths: length scales, (processes, features), of scaled features.
        variance: of the processes, (processes,).
        wander: what is another function of time in each flight.
        noise: variance of what is neither, (processes,).
        input_scale: mean and standard deviation of the features, (2, features).
        output_scale: of the outputs, (2, processes).
    """

    inputs: Tensor
    outputs: Tensor
    lengths: Tensor
    variance: Tensor
    wander: Wander
    noise: Tensor
    input_scale: Tensor
    output_scale: Tensor

    def scaled(self, queries: Tensor) -> Tensor:
        """Return features (batch, features) in their standard deviations."""
        return (queries - self.input_scale[0]) / self.input_scale[1]

    def kernel(self, left: Tensor, right: Tensor) -> Tensor:
        """Return covariances (processes, left, right) of scaled features."""
        scale = self.lengths[:, None]
        distance = torch.cdist(left / scale, right / scale).square()
        return self.variance[:, None, None] * torch.exp(-0.5 * distance)

    @cached_property
    def factor(self) -> Tensor:
        """Lower triangular factor of the covariance of the outputs, (processes, samples, samples)."""
        diagonal = self.noise + _JITTER * self.variance
        return torch.linalg.cholesky(
            self.kernel(self.inputs, self.inputs) + _diagonal(diagonal, len(self.inputs))
        )

    def solve(self, outputs: Tensor) -> Tensor:
        """Return the covariance's inverse times outputs (processes, samples, columns)."""
        return torch.cholesky_solve(outputs, self.factor)

    def foretold(self, inputs: Tensor) -> tuple[Tensor, Tensor]:
        """Return posterior mean and variance of the functions of the state, (processes, batch) each, all scaled."""
        across = self.kernel(self.inputs, inputs)
        mean = across.mT @ self.solve(self.outputs[..., None])
        whitened = torch.linalg.solve_triangular(self.factor, across, upper=False)
        return mean[..., 0], (self.variance[:, None] - whitened.square().sum(1)).clamp_min(0.0)

    def mean(self, queries: Tensor) -> Tensor:
        """Return the posterior means (batch, processes) of the functions of the state (batch, features), in units."""
        mean, _ = self.foretold(self.scaled(queries))
        return self.output_scale[0] + self.output_scale[1] * mean.T

    def deviation(self, queries: Tensor) -> Tensor:
        """Return the posterior standard deviations (batch, processes) of the functions of the state."""
        _, variance = self.foretold(self.scaled(queries))
        return self.output_scale[1] * variance.sqrt().T


def fit(
    features: Tensor, residuals: Tensor, course: Course, judged_by: int, iterations: int
) -> GaussianProcesses:
    """Return the processes with the greatest marginal likelihood that is found, and what wanders beside.

    The likelihood of both together would let time account for what the state repeats in each flight.

    Args:
        features: (samples, features).
        residuals: (samples, processes).
        course: when they were taken.
        judged_by: samples, evenly among all, whose likelihood it is; the processes know all of them.
        iterations: of the search, by L-BFGS.
    """
    inputs, input_scale = _standardised(features)
    outputs, output_scale = _standardised(residuals)
    judged = evenly(len(inputs), judged_by)
    kernel, noise = _most_likely(inputs[judged], outputs[judged], iterations)
    alone = GaussianProcesses(
        inputs,
        outputs.T.contiguous(),
        kernel.base_kernel.lengthscale.detach()[:, 0],
        kernel.outputscale.detach(),
        Wander.none(outputs.shape[1]),
        noise.detach()[:, 0],
        input_scale,
        output_scale,
    )
    return replace(alone, wander=_wander_beside(alone, course))


def _wander_beside(processes: GaussianProcesses, course: Course) -> Wander:
    """Return what flights show beyond what is foretold of them by the others; of one flight nothing can be said."""
    flights = course.flight.unique()
    if len(flights) < 2:
        return processes.wander
    error, expected = torch.empty_like(processes.outputs), torch.empty_like(processes.outputs)
    for flight in flights:
        out = course.flight == flight
        others = replace(processes, inputs=processes.inputs[~out], outputs=processes.outputs[:, ~out])
        mean, expected[:, out] = others.foretold(processes.inputs[out])
        error[:, out] = processes.outputs[:, out] - mean
    return wander_of(error, expected, course)


def _most_likely(
    inputs: Tensor, outputs: Tensor, iterations: int
) -> tuple[gpytorch.kernels.ScaleKernel, Tensor]:
    """Return the kernels of the processes and the variance of their noise, (processes, 1)."""
    model = _Model(inputs.expand(outputs.shape[1], *inputs.shape), outputs.T).double()
    model.train()
    objective = gpytorch.mlls.ExactMarginalLogLikelihood(model.likelihood, model)
    optimizer = torch.optim.LBFGS(model.parameters(), max_iter=iterations, line_search_fn="strong_wolfe")

    def unlikelihood() -> Tensor:
        optimizer.zero_grad()
        loss = -objective(model(*model.train_inputs), model.train_targets).sum()
        loss.backward()
        return loss

    with gpytorch.settings.fast_computations(False, False, False):
        optimizer.step(unlikelihood)
    return model.covariance, model.likelihood.noise


class _Model(gpytorch.models.ExactGP):  # type: ignore[misc]
    """Independent processes as a batch."""

    def __init__(self, inputs: Tensor, outputs: Tensor) -> None:
        shape = torch.Size([len(outputs)])
        within = gpytorch.constraints.Interval
        likelihood = gpytorch.likelihoods.GaussianLikelihood(
            batch_shape=shape, noise_constraint=within(*_NOISES)
        )
        super().__init__(inputs, outputs, likelihood)
        self.average = gpytorch.means.ZeroMean(batch_shape=shape)
        base = gpytorch.kernels.RBFKernel(
            ard_num_dims=inputs.shape[-1], batch_shape=shape, lengthscale_constraint=within(*_LENGTHS)
        )
        self.covariance = gpytorch.kernels.ScaleKernel(
            base, batch_shape=shape, outputscale_constraint=within(*_VARIANCES)
        )
        base.lengthscale, self.covariance.outputscale = _START_VALUES["lengths"], _START_VALUES["variance"]
        likelihood.noise = _START_VALUES["noise"]

    def forward(self, inputs: Tensor) -> "gpytorch.distributions.MultivariateNormal":
        return gpytorch.distributions.MultivariateNormal(self.average(inputs), self.covariance(inputs))


def _standardised(values: Tensor) -> tuple[Tensor, Tensor]:
    """Return values (samples, columns) about their means in their deviations, and both, (2, columns)."""
    values = values.double()
    deviation = values.std(0)
    scale = torch.stack([values.mean(0), torch.where(deviation > 0, deviation, torch.ones_like(deviation))])
    return (values - scale[0]) / scale[1], scale


def _diagonal(values: Tensor, size: int) -> Tensor:
    return values[:, None, None] * torch.eye(size, dtype=values.dtype)
