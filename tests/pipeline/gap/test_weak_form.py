import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.gap.weak_form import mean_of, mean_rate_of, window_functions
from tests.pipeline.gap.problems import random_like

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
        mean_rate_of(functions, line), torch.full((1, len(functions.centres)), slope, dtype=torch.float64),
        atol=1e-8, rtol=1e-9,
    )
    torch.testing.assert_close(
        mean_of(functions, line)[0], line[0, functions.centres], atol=1e-9, rtol=1e-9
    )


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
    orders = [math.log2(a / b) for a, b in zip(errors, errors[1:], strict=False)]
    assert min(orders) > 1.8
    assert errors[-1] < 2e-3


@pytest.mark.parametrize("gain", ["weights", "slopes"])
def test_noise_gain_is_the_sum_of_squares(gain):
    """4,000 blocks × rows: the standard deviation is known to 1 % (three standard errors allowed)."""
    functions = window_functions(100, 0.2, 0.01)
    noise = random_like((4000, 100), seed=1)
    rows = (mean_of if gain == "weights" else mean_rate_of)(functions, noise)
    expected = getattr(functions, gain).square().sum(1).sqrt()
    torch.testing.assert_close(rows.std(0), expected, rtol=3.0 / math.sqrt(2 * 4000), atol=0.0)
