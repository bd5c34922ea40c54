"""Nonlinear least squares between Gauss–Newton and steepest descent.

Hagan & Menhaj 1994, "Training feedforward networks with the Marquardt algorithm", IEEE Transactions on Neural
Networks 5(6): the damping falls tenfold after a step that lowers the error and grows tenfold until one does.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import torch
from torch import Tensor

_DAMPING, _FACTOR, _GREATEST = 0.01, 10.0, 1e10
_FLAT = 1e-12  # length of the gradient below which there is nowhere to go


class Problem(ABC):
    """Residuals e of parameters θ, as the algorithm sees them; means are over the samples."""

    @abstractmethod
    def error(self, parameters: Tensor) -> float:
        """Return the mean of e²."""

    @abstractmethod
    def normal_equations(self, parameters: Tensor) -> tuple[Tensor, Tensor]:
        """Return the means of JᵀJ (parameters, parameters) and Jᵀe (parameters,), J = ∂e/∂θ."""

    @abstractmethod
    def validation_error(self, parameters: Tensor) -> float:
        """Return the mean of e² on samples that are not fitted."""


@dataclass(frozen=True)
class Solution:
    """Where the minimisation ended.

    Attributes:
        parameters: with the lowest validation error.
        validation_error: theirs.
        errors: fitted and validation error after every step.
    """

    parameters: Tensor
    validation_error: float
    errors: list[tuple[float, float]]


def minimise(problem: Problem, parameters: Tensor, most: int, patience: int) -> Solution:
    """Minimise until the validation error stops falling, or no step lowers the fitted error.

    Args:
        problem: the residuals.
        parameters: to start from, (parameters,) float64.
        most: steps at most.
        patience: steps without a lower validation error before it stops.
    """
    error, damping = problem.error(parameters), _DAMPING
    best = Solution(parameters, problem.validation_error(parameters), [])
    errors: list[tuple[float, float]] = []
    waited = 0
    while len(errors) < most and waited < patience:
        gram, gradient = problem.normal_equations(parameters)
        if torch.linalg.vector_norm(gradient) < _FLAT:
            break
        lower = _lower(problem, parameters, error, gram, gradient, damping)
        if lower is None:
            break
        parameters, error, damping = lower
        held = problem.validation_error(parameters)
        errors.append((error, held))
        waited += 1
        if held < best.validation_error:
            best, waited = Solution(parameters, held, []), 0
    return Solution(best.parameters, best.validation_error, errors)


def _lower(
    problem: Problem, parameters: Tensor, error: float, gram: Tensor, gradient: Tensor, damping: float
) -> tuple[Tensor, float, float] | None:
    """Return parameters with a lower error, that error and the next damping; None where there are none."""
    unit = torch.eye(len(gradient), dtype=gradient.dtype, device=gradient.device)
    while damping <= _GREATEST:
        tried = parameters - torch.linalg.solve(gram + damping * unit, gradient)
        found = problem.error(tried)
        if found < error:
            return tried, found, damping / _FACTOR
        damping *= _FACTOR
    return None
