import numpy as np
import pytest

from pipeline.models.weak_form import WeakForm


@pytest.mark.parametrize("width", [0.05, 0.2, 0.5])
def test_the_rate_of_a_straight_line_is_exact(width):
    form = WeakForm.of_width(width, 0.01)
    time = np.arange(200) * 0.01
    np.testing.assert_allclose(form.mean_rate(3.0 - 2.0 * time), -2.0, rtol=1e-12)
    np.testing.assert_allclose(form.mean(np.full(200, 7.0)), 7.0, rtol=1e-12)


def test_the_rate_is_the_mean_of_the_derivative():
    form = WeakForm.of_width(0.2, 0.001)
    time = np.arange(2000) * 0.001
    series = np.column_stack([np.sin(5 * time), np.cos(3 * time)])
    derivative = np.column_stack([5 * np.cos(5 * time), -3 * np.sin(3 * time)])
    np.testing.assert_allclose(form.mean_rate(series), form.mean(derivative), atol=1e-4)


def test_noise_is_not_differentiated():
    form = WeakForm.of_width(0.4, 0.01)
    noise = np.random.default_rng(0).normal(size=4000)
    assert np.std(form.mean_rate(noise)) < 0.05 * np.std(np.diff(noise) / 0.01)


def test_every_window_has_its_centre():
    form = WeakForm.of_width(0.1, 0.01)
    for count in range(1, 60):
        series = np.arange(float(count))
        means = form.mean(series)
        if count < len(form.weights):
            assert len(means) == 0
        else:
            np.testing.assert_allclose(form.centres(series), means, atol=1e-12)
