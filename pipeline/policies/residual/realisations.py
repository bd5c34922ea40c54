"""Draws of whole functions from the posterior of Gaussian processes, to be asked anywhere at any time.

A draw is one from the prior, as a sum of random Fourier features (Rahimi & Recht 2007), and what the data add to it
(Wilson et al. 2020, "Efficiently sampling functions from Gaussian process posteriors", arXiv 2002.09309, eq. 12). It
is a function of the state, so that what it tells a machine is consistent in time, beside one of the time since the
flight began, which the data say nothing about: it is another one in every flight.
"""

import math
from dataclasses import dataclass, fields

import torch
from torch import Tensor

from simgap.policies.residual.gaussian_processes import GaussianProcesses
from simgap.policies.residual.wander import Wander
from simgap.recordings.excerpt import evenly

_FREQUENCIES = 16  # frequencies of the waves in time, a cosine and a sine of each


@dataclass(frozen=True)
class Realisations:
    """Drawn functions of scaled features, float32.

    Attributes:
        frequencies: (processes, features, waves).
        phases: (processes, waves).
        weights: of the waves, (draws, processes, waves).
        anchors: scaled features, (anchors, features).
        lengths: length scales, (processes, features).
        corrections: weights of the kernels at the anchors, (draws, processes, anchors).
        paces: frequencies of the waves in time, (processes, paces) rad/s.
        wanderings: weights of their cosines and then of their sines, (draws, processes, 2·paces).
        input_scale: mean and standard deviation of the features, (2, features).
        output_scale: of the outputs, (2, processes).
    """

    frequencies: Tensor
    phases: Tensor
    weights: Tensor
    anchors: Tensor
    lengths: Tensor
    corrections: Tensor
    paces: Tensor
    wanderings: Tensor
    input_scale: Tensor
    output_scale: Tensor

    def __len__(self) -> int:
        """Return how many functions were drawn."""
        return len(self.weights)

    def __call__(self, queries: Tensor, moments: Tensor, draw: Tensor) -> Tensor:
        """Return residuals (batch, processes).

        Args:
            queries: features (batch, features).
            moments: since the flights began, (batch,) s.
            draw: which function each machine has, (batch,).
        """
        scaled = (queries - self.input_scale[0]) / self.input_scale[1]
        waves = torch.cos(scaled @ self.frequencies + self.phases[:, None])  # (processes, batch, waves)
        scale = self.lengths[:, None]
        near = torch.exp(-0.5 * torch.cdist(scaled / scale, self.anchors / scale).square())
        basis = torch.cat([waves, near], dim=-1).transpose(0, 1)  # (batch, processes, waves + anchors)
        together = torch.cat([self.weights, self.corrections], dim=-1)[draw]
        angles = moments[:, None, None] * self.paces
        passing = torch.cat([angles.cos(), angles.sin()], dim=-1) * self.wanderings[draw]
        return self.output_scale[0] + self.output_scale[1] * ((basis * together).sum(-1) + passing.sum(-1))

    def to(self, device: torch.device | str) -> "Realisations":
        """Return the draws on a device."""
        return Realisations(**{name: tensor.to(device) for name, tensor in self.tensors().items()})

    def tensors(self) -> dict[str, Tensor]:
        """Return all numbers by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def draw(processes: GaussianProcesses, count: int, waves: int, anchors: int, seed: int) -> Realisations:
    """Draw functions from the posterior.

    Args:
        processes: fitted.
        count: draws.
        waves: random Fourier features of each process, a cosine and a sine of half as many frequencies.
        anchors: samples, evenly among those of the fit, whose kernels carry what the data add; all of them are exact.
        seed: of the draws.
    """
    random = torch.Generator().manual_seed(seed)
    frequencies = torch.stack([_frequencies(lengths, waves // 2, random) for lengths in processes.lengths])
    frequencies = frequencies.repeat(1, 1, 2)
    shape = frequencies.shape
    phases = frequencies.new_zeros(shape[0], shape[2])
    phases[:, waves // 2 :] = -0.5 * math.pi  # a sine beside each cosine
    weights = torch.randn(count, *phases.shape, generator=random, dtype=torch.float64)
    weights = weights * (2.0 * processes.variance / shape[2]).sqrt()[:, None]
    prior = torch.cos(processes.inputs @ frequencies + phases[:, None]) @ weights.permute(1, 2, 0)
    noise = (
        torch.randn(prior.shape, generator=random, dtype=torch.float64)
        * processes.noise.sqrt()[:, None, None]
    )
    added = processes.solve(processes.outputs[..., None] - prior - noise)  # (processes, samples, draws)
    chosen = processes.inputs[evenly(len(processes.inputs), anchors)]
    corrections = _carried(processes, chosen, added)
    paces, wanderings = _wanderings(processes.wander, count, random)
    numbers = (
        frequencies,
        phases,
        weights,
        chosen,
        processes.lengths,
        corrections.permute(2, 0, 1),
        paces,
        wanderings,
        processes.input_scale,
        processes.output_scale,
    )
    return Realisations(*(tensor.float().contiguous() for tensor in numbers))


def _wanderings(wander: Wander, count: int, random: torch.Generator) -> tuple[Tensor, Tensor]:
    """Return frequencies (processes, paces) and weights (draws, processes, 2·paces) of waves in time."""
    paces = torch.stack([_frequencies(time[None], _FREQUENCIES, random)[0] for time in wander.time])
    weights = torch.randn(count, len(paces), 2 * _FREQUENCIES, generator=random, dtype=torch.float64)
    return paces, weights * (wander.variance / _FREQUENCIES).sqrt()[:, None]


def _frequencies(lengths: Tensor, count: int, random: torch.Generator) -> Tensor:
    """Return frequencies (features, count) of a squared exponential kernel, evenly over their distribution."""
    seed = int(torch.randint(2**31 - 1, (1,), generator=random))
    even = torch.quasirandom.SobolEngine(len(lengths), scramble=True, seed=seed).draw(
        count, dtype=torch.float64
    )
    normal = math.sqrt(2.0) * torch.special.erfinv((2.0 * even - 1.0).clamp(-1.0 + 1e-9, 1.0 - 1e-9))
    return normal.T / lengths[:, None]


def _carried(processes: GaussianProcesses, anchors: Tensor, added: Tensor) -> Tensor:
    """Return weights (processes, anchors, draws) of correlations at anchors that come closest to what the data add."""
    wanted = processes.kernel(processes.inputs, processes.inputs) @ added
    near = processes.kernel(processes.inputs, anchors)
    weight = 1e-6 * processes.variance.square()[:, None, None] * len(anchors)
    square = near.transpose(1, 2) @ near + weight * torch.eye(len(anchors), dtype=near.dtype)
    found = torch.cholesky_solve(near.transpose(1, 2) @ wanted, torch.linalg.cholesky(square))
    return found * processes.variance[:, None, None]
