"""What of a residual is a function of time alone, another one in every flight: how large, and how soon forgotten."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

_LEAST_TIME = 1e-3  # s


@dataclass(frozen=True)
class Course:
    """When samples were taken, in their order.

    Attributes:
        flight: number of the flight, (samples,).
        moment: since it began, (samples,) s.
    """

    flight: Tensor
    moment: Tensor


@dataclass(frozen=True)
class Wander:
    """Gaussian processes of time with squared exponential kernels, independent from flight to flight.

    Attributes:
        variance: (processes,).
        time: length scale, (processes,) s.
    """

    variance: Tensor
    time: Tensor

    @staticmethod
    def none(processes: int) -> "Wander":
        """Return processes that are zero."""
        return Wander(torch.zeros(processes).double(), torch.ones(processes).double())


def wander_of(error: Tensor, expected: Tensor, course: Course) -> Wander:
    """Return processes that are as large as what of errors lasts from sample to sample, and forgotten as soon.

    Args:
        error: of samples in the order of their flights, (processes, samples).
        expected: variance that they have since the function of the state is not known better, (processes, samples).
        course: of the samples.
    """
    _, counts = torch.unique_consecutive(course.flight, return_counts=True)
    lags = range(1, max(int(counts.min()) // 2, 2))
    lasting = torch.stack([_lagged(error, course.flight, lag) for lag in lags])
    fallen = lasting < math.exp(-0.5) * lasting[0]
    first = torch.where(fallen.any(0), fallen.int().argmax(0) + 1, len(lags))
    step = float(course.moment.diff().clamp_min(0.0).median())
    variance = (lasting[0] - expected.mean(1)).clamp_min(0.0)
    return Wander(variance, (step * first.double()).clamp_min(_LEAST_TIME))


def _lagged(error: Tensor, flight: Tensor, lag: int) -> Tensor:
    """Return the mean product of errors so many samples apart in the same flight, (processes,); 0 where none are."""
    same = flight[lag:] == flight[:-lag]
    return (error[:, lag:] * error[:, :-lag] * same).sum(1) / same.sum().clamp_min(1)
