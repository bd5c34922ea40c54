"""A network of one hidden layer and one output, with the derivatives by its parameters written out."""

from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.models.levenberg_marquardt import Problem

_CHUNK = 4096  # samples whose derivatives are worked on at a time


def parameter_count(inputs: int, hidden: int) -> int:
    """Return how many parameters a network has."""
    return hidden * (inputs + 1) + hidden + 1


def start(inputs: int, hidden: int, random: torch.Generator) -> Tensor:
    """Return parameters to start from: normal, the sum into each unit of unit variance."""
    weights = torch.randn(hidden, inputs + 1, generator=random, dtype=torch.float64) / (inputs + 1) ** 0.5
    output = torch.randn(hidden + 1, generator=random, dtype=torch.float64) / (hidden + 1) ** 0.5
    return torch.cat([weights.flatten(), output])


def predict(parameters: Tensor, inputs: Tensor) -> Tensor:
    """Return v·tanh(W·x + b) + c.

    Args:
        parameters: rows of [W b], then v and c, (parameters,).
        inputs: x (samples, inputs).

    Returns:
        (samples,).
    """
    weights, output = _parts(parameters, inputs.shape[1])
    return torch.tanh(_with_one(inputs) @ weights.T) @ output[:-1] + output[-1]


def jacobian(parameters: Tensor, inputs: Tensor) -> Tensor:
    """Return the derivatives of `predict` by the parameters, (samples, parameters)."""
    weights, output = _parts(parameters, inputs.shape[1])
    extended = _with_one(inputs)
    active = torch.tanh(extended @ weights.T)
    slope = output[:-1] * (1.0 - active.square())
    inner = (slope[:, :, None] * extended[:, None, :]).flatten(1)
    return torch.cat([inner, _with_one(active)], dim=1)


@dataclass(frozen=True)
class Regression(Problem):
    """The residuals of a network, predicted minus true.

    Attributes:
        inputs: (samples, inputs).
        targets: (samples,).
        held_inputs: of the validation.
        held_targets: of the validation.
    """

    inputs: Tensor
    targets: Tensor
    held_inputs: Tensor
    held_targets: Tensor

    def error(self, parameters: Tensor) -> float:
        """Return the mean squared residual."""
        return float((predict(parameters, self.inputs) - self.targets).square().mean())

    def validation_error(self, parameters: Tensor) -> float:
        """Return the mean squared residual of the validation."""
        return float((predict(parameters, self.held_inputs) - self.held_targets).square().mean())

    def normal_equations(self, parameters: Tensor) -> tuple[Tensor, Tensor]:
        """Return the means of JᵀJ and Jᵀe."""
        count = len(parameters)
        gram, gradient = parameters.new_zeros(count, count), parameters.new_zeros(count)
        for inputs, targets in zip(self.inputs.split(_CHUNK), self.targets.split(_CHUNK), strict=True):
            slopes = jacobian(parameters, inputs)
            gram += slopes.T @ slopes
            gradient += slopes.T @ (predict(parameters, inputs) - targets)
        return gram / len(self.inputs), gradient / len(self.inputs)


def _parts(parameters: Tensor, inputs: int) -> tuple[Tensor, Tensor]:
    hidden = (len(parameters) - 1) // (inputs + 2)
    inner, output = parameters.split([hidden * (inputs + 1), hidden + 1])
    return inner.view(hidden, inputs + 1), output


def _with_one(values: Tensor) -> Tensor:
    return torch.cat([values, torch.ones_like(values[:, :1])], dim=1)
