"""The networks of a policy and of its critic."""

import math
from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import Tensor, nn

_OUTPUT_GAIN = 0.01  # a policy begins near zero action, whatever it sees


def perceptron(sizes: Sequence[int], slope: float, gain: float) -> nn.Sequential:
    """Return linear layers with LeakyReLU between them, weights orthogonal (Saxe et al. 2014, arXiv 1312.6120).

    Args:
        sizes: of input, hidden layers and output.
        slope: of LeakyReLU below zero.
        gain: of the last layer's weights.
    """
    layers: list[nn.Module] = []
    for number, (inputs, outputs) in enumerate(pairwise(sizes)):
        last = number == len(sizes) - 2
        layer = nn.Linear(inputs, outputs)
        nn.init.orthogonal_(layer.weight, gain if last else nn.init.calculate_gain("leaky_relu", slope))
        nn.init.zeros_(layer.bias)
        layers += [layer] if last else [layer, nn.LeakyReLU(slope)]
    return nn.Sequential(*layers)


class Gaussian(nn.Module):
    """A normal distribution of actions whose mean follows the observation and whose deviation does not."""

    def __init__(
        self, observation_size: int, action_size: int, hidden: Sequence[int], slope: float, deviation: float
    ) -> None:
        super().__init__()
        self.mean = perceptron([observation_size, *hidden, action_size], slope, _OUTPUT_GAIN)
        self.log_deviation = nn.Parameter(torch.full((action_size,), math.log(deviation)))

    def forward(self, observation: Tensor) -> tuple[Tensor, Tensor]:
        """Return mean and standard deviation, both (..., action_size), for an observation (..., observation_size)."""
        mean = self.mean(observation)
        return mean, self.log_deviation.exp().expand_as(mean)

    def sample(self, observation: Tensor, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Return actions (batch, action_size) and the logarithms of their densities (batch,)."""
        mean, deviation = self(observation)
        noise = torch.randn(mean.shape, generator=generator, device=mean.device, dtype=mean.dtype)
        density = -0.5 * noise.square() - self.log_deviation - 0.5 * math.log(2.0 * math.pi)
        return mean + deviation * noise, density.sum(-1)

    @torch.no_grad()
    def widen(self, deviation: float) -> None:
        """Raise standard deviations that are smaller to this one, so that the actions explore again."""
        self.log_deviation.clamp_(min=math.log(deviation))


class Policy(nn.Module):
    """The deployed policy: the most likely action, within its bounds."""

    def __init__(self, gaussian: Gaussian) -> None:
        super().__init__()
        self.mean = gaussian.mean

    def forward(self, observation: Tensor) -> Tensor:
        """Return an action (..., action_size) within ±1 for an observation (..., observation_size)."""
        return self.mean(observation).clamp(-1.0, 1.0)


class Critic(nn.Module):
    """Value function with privileged observations."""

    def __init__(
        self, observation_size: int, privileged_size: int, hidden: Sequence[int], slope: float
    ) -> None:
        super().__init__()
        self.value = perceptron([observation_size + privileged_size, *hidden, 1], slope, gain=1.0)

    def forward(self, observation: Tensor, privileged: Tensor) -> Tensor:
        """Return the value (..., 1)."""
        return self.value(torch.cat([observation, privileged], dim=-1))
