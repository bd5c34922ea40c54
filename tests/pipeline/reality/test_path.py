import numpy as np
import pytest

from pipeline.reality.case import PlantCase
from pipeline.reality.path import MANOEUVRES, plan

CASE = PlantCase(runs=10, duration=20.0)


@pytest.fixture(scope="module")
def paths():
    return plan(CASE, np.random.default_rng(3))


def test_derivatives_are_those_of_the_path(paths):
    times, small = np.linspace(0.0, 20.0, 50), 1e-4
    _, first, second = paths.at(times)
    before, after = paths.at(times - small), paths.at(times + small)
    np.testing.assert_allclose((after[0] - before[0]) / (2 * small), first, atol=1e-6)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * small), second, atol=1e-5)


def test_gentle_and_fast_runs_of_every_manoeuvre(paths):
    assert {name.split("_")[0] for name in paths.names} == set(MANOEUVRES)
    velocity = paths.at(np.linspace(0.0, CASE.duration, 2000))[1][..., :3]
    peaks = np.sort(np.linalg.norm(velocity, axis=-1).max(axis=0))
    assert peaks[0] == pytest.approx(CASE.slowest, rel=0.25)
    assert peaks[-1] == pytest.approx(CASE.fastest, rel=0.25)


def test_no_path_asks_for_more_acceleration_than_it_may(paths):
    acceleration = paths.at(np.linspace(0.0, CASE.duration, 2000))[2][..., :3]
    assert np.linalg.norm(acceleration, axis=-1).max() < 1.15 * CASE.acceleration


def test_every_path_stays_above_the_floor(paths):
    assert paths.at(np.linspace(0.0, CASE.duration, 2000))[0][..., 2].min() > 1.0


def test_the_same_seed_plans_the_same_paths(paths):
    again = plan(CASE, np.random.default_rng(3))
    np.testing.assert_array_equal(again.at(7.0)[0], paths.at(7.0)[0])
