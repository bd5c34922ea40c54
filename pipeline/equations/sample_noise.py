"""White noise on a sampled series, told from physics by its fifth difference."""

import torch
from torch import Tensor

from simgap.recordings.cleaning.resample import FIFTH_DIFFERENCE

_FIFTH_DIFFERENCE = torch.tensor(FIFTH_DIFFERENCE, dtype=torch.float64)
_RESIDUAL_ROUNDING = 1e-9  # of the mean square: a signal that rests leaves no more
_MEDIAN_OF_SQUARE = 0.4549364  # median of a squared standard normal


def sample_noise(series: Tensor, kept: float = 1.0) -> Tensor:
    """Return the variance of the white noise on a series (blocks, samples).

    Args:
        series: with noise on it.
        kept: share of it that a fifth difference still shows, where the series was interpolated.
    """
    kernel = _FIFTH_DIFFERENCE.to(series)
    squared = torch.nn.functional.conv1d(series[:, None], kernel[None, None]).square() / kernel.square().sum()
    # The median forgives steps of a command and spikes; a quantised signal that rests has none, hence the mean.
    median, mean = squared.median() / _MEDIAN_OF_SQUARE, squared.mean()
    return (median if median > _RESIDUAL_ROUNDING * mean else mean) / kept
