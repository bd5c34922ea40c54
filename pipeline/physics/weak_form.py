"""Equations of motion without differentiating noise: multiplied by test functions and integrated by parts.

For a smooth w(t) that vanishes at both ends of its window, ∫ w·(dq/dt) dt = −∫ (dw/dt)·q dt. A recorded quantity q
is therefore never differentiated; each result is a weighted mean over one window, in the quantity's unit. Blocks of
equal length are covered to their ends; along a series of any length one window moves on by half its width.
Source: Messenger & Bortz 2021, Weak SINDy (SIAM Multiscale Model. Simul. 19(3)), eqs. 2.2–2.5.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor

LEAST_WINDOW = 8
"""Steps from one end of a test function to the other, at least."""


@dataclass(frozen=True)
class WindowFunctions:
    """Test functions on the samples of a block.

    Attributes:
        weights: (rows, samples); each row sums to one, so that it takes a weighted mean.
        slopes: (rows, samples), 1/s; applied to a momentum, each gives the weighted mean of its rate.
        centres: sample at the centre of each row.
        differences: (rows, samples), 1/s; applied to a momentum, each gives the mean of its central difference: the
            mean rate over the two steps that meet at a sample, exact where what acts is held from sample to sample.
    """

    weights: Float[Tensor, "rows samples"]
    slopes: Float[Tensor, "rows samples"]
    centres: Int[Tensor, " rows"]
    differences: Float[Tensor, "rows samples"]


@dataclass(frozen=True)
class MovingWindow:
    """One test function on the samples of its own window.

    Attributes:
        weights: (window,); sums to one, so that it takes a weighted mean.
        slopes: (window,), 1/s; applied to a quantity, it gives the weighted mean of its rate.
        stride: samples from one window to the next: half a window.
    """

    weights: Float[Tensor, " window"]
    slopes: Float[Tensor, " window"]
    stride: int


def window_functions(samples: int, width: float, time_step: float) -> WindowFunctions:
    """Place test functions (1 − s²)³ that overlap by half over a block.

    Args:
        samples: length of the block.
        width: of each function, s; at least eight samples are used, at most the block.
        time_step: s.
    """
    half = min(_half(width, time_step), (samples - 1) // 2)
    first, last = half, samples - 1 - half
    count = max((last - first) // half + 1, 1)
    centres = torch.linspace(first, last, count, dtype=torch.float64).round()
    offset = torch.arange(samples, dtype=torch.float64) - centres[:, None]
    weights, slopes = _test_functions(offset, half, time_step)
    beside = torch.nn.functional.pad(weights, (1, 1))
    differences = (beside[:, :-2] - beside[:, 2:]) / (2.0 * time_step)
    return WindowFunctions(weights, slopes, centres.long(), differences)


def mean_of(
    functions: WindowFunctions, series: Float[Tensor, "blocks samples"]
) -> Float[Tensor, "blocks rows"]:
    """Return the weighted means (blocks, rows) of a series (blocks, samples)."""
    return series @ functions.weights.T


def mean_rate_of(
    functions: WindowFunctions, momentum: Float[Tensor, "blocks samples"], held: bool = False
) -> Float[Tensor, "blocks rows"]:
    """Return the weighted means (blocks, rows) of the rate of a momentum (blocks, samples).

    Args:
        functions: the windows.
        momentum: (blocks, samples).
        held: whether what acts on it is held from sample to sample, so that it runs in straight lines between them.
    """
    return momentum @ (functions.differences if held else functions.slopes).T


def moving_window(width: float, time_step: float) -> MovingWindow:
    """Return the test function (1 − s²)³ of a width in s, of eight samples at least; time step in s."""
    half = _half(width, time_step)
    offset = torch.arange(-half, half + 1, dtype=torch.float64)
    return MovingWindow(*_test_functions(offset, half, time_step), half)


def moving_mean_of(
    window: MovingWindow, series: Float[Tensor, "*batch samples"]
) -> Float[Tensor, "*batch windows"]:
    """Return the weighted means (..., windows) of a series (..., samples); none where it is too short."""
    return _averaged(window.weights, window.stride, series)


def moving_mean_rate_of(
    window: MovingWindow, series: Float[Tensor, "*batch samples"]
) -> Float[Tensor, "*batch windows"]:
    """Return the weighted means (..., windows) of the rate of a series (..., samples)."""
    return _averaged(window.slopes, window.stride, series)


def moving_centres(window: MovingWindow, samples: int) -> Int[Tensor, " windows"]:
    """Return the sample at the centre of each window (windows,) along a series of so many samples."""
    return torch.arange(samples)[window.stride : -window.stride : window.stride]


def _half(width: float, time_step: float) -> int:
    return max(round(width / time_step / 2), LEAST_WINDOW // 2)


def _test_functions(offset: Tensor, half: int, time_step: float) -> tuple[Tensor, Tensor]:
    """Return weights and slopes (..., samples) at offsets from the centre (..., samples), in samples."""
    place = offset / half
    inside = (1.0 - place**2).clamp_min(0.0)
    weights = inside**3
    slopes = -6.0 * place * inside**2
    # Scaled so that the rate of a straight line comes out exact on the sampled functions.
    moment = (slopes * offset * time_step).sum(-1, keepdim=True)
    return weights / weights.sum(-1, keepdim=True), slopes / moment


def _averaged(function: Tensor, stride: int, series: Tensor) -> Tensor:
    if series.shape[-1] < len(function):
        return series.new_zeros(*series.shape[:-1], 0)
    return series.unfold(-1, len(function), stride) @ function
