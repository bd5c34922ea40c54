import numpy as np
import pytest

from simgap.plants.case import PlantCase
from simgap.plants.path import MANOEUVRES, plan

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


def flown(**kwargs):
    paths = plan(PlantCase(runs=5, duration=20.0, **kwargs), np.random.default_rng(3))
    return paths, paths.at(np.linspace(0.0, 20.0, 2000))


def test_over_a_floor_that_is_to_be_felt_paths_come_down_to_it():
    for effects in ({}, {"ground_effect": 1e-3}):
        _, (place, speed, quickening) = flown(flights="low", effects=effects)
        lowest, highest = place[..., 2].min(axis=0), place[..., 2].max(axis=0)
        assert (lowest > 0.1).all()
        assert (highest < 0.55).all()
        assert (highest - lowest).min() > 0.1
        assert np.linalg.norm(speed[..., :3], axis=-1).max() < 2.0
        assert np.linalg.norm(quickening[..., :3], axis=-1).max() < 3.0


def test_poor_flights_leave_out_what_their_name_says():
    _, (hovering, still, _) = flown(flights="hover")
    np.testing.assert_array_equal(still, 0.0)
    assert (hovering[..., 2] > 1.0).all()
    _, (line, _, _) = flown(flights="line")
    np.testing.assert_array_equal(np.ptp(line[..., 1:], axis=0), 0.0)
    assert (np.ptp(line[..., 0], axis=0) > 1.0).all()
    paths, (level, _, _) = flown(flights="level")
    np.testing.assert_array_equal(np.ptp(level[..., 2], axis=0), 0.0)
    assert (np.ptp(level[..., :2], axis=0).max(axis=-1) > 1.0).all()
    assert {name.split("_")[0] for name in paths.names} == set(MANOEUVRES)
