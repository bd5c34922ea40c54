"""A fractional shift along the time of recorded blocks."""

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.physics.shapes import Series


def shift_in_time(
    series: Series, delay: float | Float[Tensor, ""] | Float[Tensor, "#blocks"], time_step: float
) -> Series:
    """Return series(t − delay), linear between samples; the ends hold their last value.

    Differentiable in the delay. The gradient is the slope between the two neighbouring samples.

    Args:
        series: (blocks, samples, ...).
        delay: s, one number for all blocks or one per block (blocks,).
        time_step: s.
    """
    shift = torch.as_tensor(delay, dtype=series.dtype) / time_step
    whole = torch.floor(shift.detach())
    fraction = (shift - whole).reshape(-1, *[1] * (series.ndim - 1))
    earlier = _taken(series, whole.long())
    return earlier + fraction * (_taken(series, whole.long() + 1) - earlier)


def _taken(series: Tensor, samples: Tensor) -> Tensor:
    place = torch.arange(series.shape[1], device=series.device)
    if samples.ndim == 0:
        return series[:, (place - samples).clamp(0, series.shape[1] - 1)]
    index = (place - samples[:, None]).clamp(0, series.shape[1] - 1)
    return series[torch.arange(series.shape[0], device=series.device)[:, None], index]
