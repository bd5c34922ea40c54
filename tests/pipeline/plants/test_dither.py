import numpy as np
import pytest

from simgap.plants.case import PlantCase
from simgap.plants.dither import shake


def test_it_shakes_as_much_as_it_says_and_no_more():
    dither = shake(PlantCase(runs=3, excitation=2.0), np.random.default_rng(0))
    values = dither.at(np.arange(0.0, 60.0, 0.01))
    np.testing.assert_allclose(values.std(axis=0), 2.0 * np.array([[0.8, 0.25, 0.25, 0.12]] * 3), rtol=0.05)
    np.testing.assert_allclose(values.mean(axis=0), 0.0, atol=0.05)


def test_runs_and_channels_are_shaken_differently():
    dither = shake(PlantCase(runs=3), np.random.default_rng(0))
    values = dither.at(np.arange(0.0, 60.0, 0.01)).reshape(-1, 12)
    correlation = np.corrcoef(values.T) - np.eye(12)
    assert np.abs(correlation).max() < 0.25


def test_it_can_be_left_out():
    dither = shake(PlantCase(runs=2, excitation=0.0), np.random.default_rng(0))
    assert dither.at(1.7) == pytest.approx(0.0)
