import numpy as np
import pytest

from simgap.plants.case import PlantCase
from simgap.plants.wind import first_order_noise, wind_along


def test_still_air_is_no_wind():
    assert wind_along(PlantCase(), 10, 1e-3, np.random.default_rng(0)) is None


def test_a_steady_wind_is_the_same_always_and_everywhere():
    case = PlantCase(runs=2, effects={"steady_wind": {"wind_x": 3.0, "wind_y": -1.0}})
    wind = wind_along(case, 5, 1e-3, np.random.default_rng(0))
    np.testing.assert_array_equal(wind, np.broadcast_to([3.0, -1.0, 0.0], (5, 2, 3)))


def test_gusts_have_the_stated_speed_along_the_ground_and_half_of_it_upwards():
    case = PlantCase(runs=40, outside={"gusts": 2.0})
    wind = wind_along(case, 20000, 0.01, np.random.default_rng(0))
    np.testing.assert_allclose(wind.std(axis=(0, 1)), [2.0, 2.0, 1.0], rtol=0.05)
    np.testing.assert_allclose(wind.mean(axis=(0, 1)), 0.0, atol=0.15)


def test_noise_forgets_exponentially():
    noise = first_order_noise((200000, 1), 0.1, np.random.default_rng(0))[:, 0]
    for lag in (1, 5, 10):
        assert (noise[:-lag] * noise[lag:]).mean() == pytest.approx(np.exp(-0.1 * lag), abs=0.03)
