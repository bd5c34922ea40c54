"""A fractional shift along the time of recorded blocks."""

import math

import torch
from torch import Tensor


def shift_in_time(series: Tensor, delay: Tensor | float, time_step: float) -> Tensor:
    """Return series(t − delay), linear between samples; the ends hold their last value.

    Differentiable in the delay, with the slope between the two samples that it falls between.

    Args:
        series: (blocks, samples, ...).
        delay: s, one number for all blocks or one per block (blocks,).
        time_step: s.
    """
    samples = torch.as_tensor(delay, dtype=series.dtype) / time_step
    if samples.ndim == 0:
        return _shift_all(series, samples)
    pairs = zip(series, samples, strict=True)
    return torch.cat([_shift_all(block[None], shift) for block, shift in pairs])


def _shift_all(series: Tensor, samples: Tensor) -> Tensor:
    whole = math.floor(samples)
    fraction = samples - whole
    return (1.0 - fraction) * _roll(series, whole) + fraction * _roll(series, whole + 1)


def _roll(series: Tensor, samples: int) -> Tensor:
    index = (torch.arange(series.shape[1]) - samples).clamp(0, series.shape[1] - 1)
    return series[:, index]
