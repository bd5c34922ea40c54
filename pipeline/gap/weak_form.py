"""Residuals without differentiating noise: equations of motion multiplied by test functions and integrated by parts.

For a smooth w(t) that vanishes at both ends of its window, ∫ w·(dq/dt) dt = −∫ (dw/dt)·q dt. A recording's momentum q
is therefore never differentiated; each row of a residual is a weighted mean over one window, in the channel's unit.
Source: Messenger & Bortz 2021, Weak SINDy (SIAM Multiscale Model. Simul. 19(3)), eqs. 2.2–2.5.
"""

from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class WindowFunctions:
    """Test functions on the samples of a block.

    Attributes:
        weights: (rows, samples); each row sums to one, so that it takes a weighted mean.
        slopes: (rows, samples), 1/s; applied to a momentum, each gives the weighted mean of its rate.
        centres: sample at the centre of each row.
    """

    weights: Tensor
    slopes: Tensor
    centres: Tensor


def window_functions(samples: int, width: float, time_step: float) -> WindowFunctions:
    """Place test functions (1 − s²)³ that overlap by half over a block.

    Args:
        samples: length of the block.
        width: of each function, s; at least eight samples are used, at most the block.
        time_step: s.
    """
    half = min(max(round(width / time_step / 2), 4), (samples - 1) // 2)
    first, last = half, samples - 1 - half
    count = max((last - first) // half + 1, 1)
    centres = torch.linspace(first, last, count, dtype=torch.float64).round()
    place = (torch.arange(samples, dtype=torch.float64) - centres[:, None]) / half
    inside = (1.0 - place**2).clamp_min(0.0)
    weights = inside**3
    slopes = -6.0 * place * inside**2
    weights = weights / weights.sum(1, keepdim=True)
    time = (torch.arange(samples, dtype=torch.float64) - centres[:, None]) * time_step
    # Scaled so that the rate of a straight line comes out exact on the sampled functions.
    slopes = slopes / (slopes * time).sum(1, keepdim=True)
    return WindowFunctions(weights, slopes, centres.long())


def mean_of(functions: WindowFunctions, series: Tensor) -> Tensor:
    """Return the weighted means (blocks, rows) of a series (blocks, samples)."""
    return series @ functions.weights.T


def mean_rate_of(functions: WindowFunctions, momentum: Tensor) -> Tensor:
    """Return the weighted means (blocks, rows) of the rate of a momentum (blocks, samples)."""
    return momentum @ functions.slopes.T
