import itertools
import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.physics.weak_form import (
    mean_of,
    mean_rate_of,
    moving_centres,
    moving_mean_of,
    moving_mean_rate_of,
    moving_window,
    window_functions,
)

lengths = st.integers(10, 300)
widths = st.floats(0.01, 2.0)
steps = st.floats(1e-3, 0.05)


@settings(max_examples=40)
@given(lengths, widths, steps)
def test_weights_take_means_and_slopes_ignore_what_is_constant(samples, width, step):
    functions = window_functions(samples, width, step)
    ones = torch.ones(1, samples, dtype=torch.float64)
    torch.testing.assert_close(mean_of(functions, ones), torch.ones_like(mean_of(functions, ones)))
    assert (functions.weights >= 0).all()
    rate = mean_rate_of(functions, 7.0 * ones)
    assert rate.abs().max() < 1e-9 / step


@settings(max_examples=40)
@given(lengths, widths, steps, st.floats(-5, 5), st.floats(-5, 5))
def test_straight_lines_are_exact(samples, width, step, offset, slope):
    functions = window_functions(samples, width, step)
    time = torch.arange(samples, dtype=torch.float64) * step
    line = (offset + slope * time)[None]
    torch.testing.assert_close(
        mean_rate_of(functions, line),
        torch.full((1, len(functions.centres)), slope, dtype=torch.float64),
        atol=1e-8,
        rtol=1e-9,
    )
    torch.testing.assert_close(mean_of(functions, line)[0], line[0, functions.centres], atol=1e-9, rtol=1e-9)


@settings(max_examples=40)
@given(lengths, widths, steps)
def test_windows_lie_inside_the_block_and_cover_it(samples, width, step):
    functions = window_functions(samples, width, step)
    assert functions.weights[:, [0, -1]].max() == 0.0
    if len(functions.centres) > 1:
        assert functions.weights.sum(0)[1:-1].gt(0).all()
    assert torch.equal(functions.weights.argmax(1), functions.centres)


def _error(step: float) -> float:
    """Largest difference between the mean rate of sin and the mean of cos, both over the same windows."""
    samples = round(1.0 / step) + 1
    functions = window_functions(samples, 0.2, step)
    time = torch.arange(samples, dtype=torch.float64) * step
    difference = mean_rate_of(functions, torch.sin(6.0 * time)[None])
    difference = difference - mean_of(functions, 6.0 * torch.cos(6.0 * time)[None])
    return float(difference.abs().max())


def test_integration_by_parts_converges_at_second_order_or_better():
    errors = [_error(step) for step in (0.02, 0.01, 0.005)]
    orders = [math.log2(a / b) for a, b in itertools.pairwise(errors)]
    assert min(orders) > 1.8
    assert errors[-1] < 2e-3


@pytest.mark.parametrize("gain", ["weights", "slopes"])
def test_noise_gain_is_the_sum_of_squares(gain):
    """4,000 blocks × rows: the standard deviation is known to 1 % (three standard errors allowed)."""
    functions = window_functions(100, 0.2, 0.01)
    noise = torch.randn(4000, 100, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    rows = (mean_of if gain == "weights" else mean_rate_of)(functions, noise)
    expected = getattr(functions, gain).square().sum(1).sqrt()
    torch.testing.assert_close(rows.std(0), expected, rtol=3.0 / math.sqrt(2 * 4000), atol=0.0)


@settings(max_examples=40)
@given(st.integers(1, 300), widths, steps)
def test_a_moving_window_has_a_mean_and_a_centre_wherever_it_fits(samples, width, step):
    window = moving_window(width, step)
    series = torch.arange(samples, dtype=torch.float64).expand(2, samples)
    means = moving_mean_of(window, series)
    expected = max((samples - len(window.weights)) // window.stride + 1, 0)
    assert means.shape == (2, expected)
    centres = moving_centres(window, samples).double().expand(2, expected)
    torch.testing.assert_close(means, centres, atol=1e-9, rtol=0.0)
    rates = moving_mean_rate_of(window, series * step)
    torch.testing.assert_close(rates, torch.ones_like(rates), atol=1e-8, rtol=0.0)


@pytest.mark.parametrize("half", [4, 7, 50])
def test_a_moving_window_is_the_function_of_a_block_that_it_fills(half):
    step = 0.01
    window = moving_window(2 * half * step, step)
    filled = window_functions(2 * half + 1, 2 * half * step, step)
    torch.testing.assert_close(filled.weights[0], window.weights)
    torch.testing.assert_close(filled.slopes[0], window.slopes)


def test_the_moving_rate_is_the_mean_of_the_derivative():
    window = moving_window(0.2, 0.001)
    time = torch.arange(2000, dtype=torch.float64) * 0.001
    series = torch.stack([torch.sin(5 * time), torch.cos(3 * time)])
    derivative = torch.stack([5 * torch.cos(5 * time), -3 * torch.sin(3 * time)])
    expected = moving_mean_of(window, derivative)
    torch.testing.assert_close(moving_mean_rate_of(window, series), expected, atol=1e-4, rtol=0.0)


def test_noise_is_not_differentiated():
    noise = torch.randn(4000, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    differentiated = noise.diff() / 0.01
    assert moving_mean_rate_of(moving_window(0.4, 0.01), noise).std() < 0.05 * differentiated.std()
