"""The time-optimal plan is flown as fast as it was planned."""

import copy

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from simgap.policies.environment import Observation
from simgap.policies.racing.laps import fly_laps
from simgap.policies.racing.model_predictive import bounded_least, time_optimal_pilot
from simgap.policies.racing.settings import RacingSettings, Starts
from tests.pipeline.gates.tracks import track_named
from tests.pipeline.policies.racing.machines import COARSE, racing

CALM = Starts(position=0.1, velocity=0.1, attitude=0.02, body_rate=0.1)
SETTINGS = RacingSettings(flying=COARSE, starts=CALM)


@pytest.fixture(scope="module")
def planned():
    return time_optimal_pilot(track_named("tiny"), SETTINGS, gravity=9.81)


@pytest.fixture
def pilot(planned):
    return copy.copy(planned)  # at the start again


def seen(position, velocity, rotation):
    """Return what is seen in a state, as far as the pilot looks at it."""
    turn = rotation.flatten(1)
    return Observation(torch.cat([position / 10.0, velocity / 10.0, turn], dim=1), turn[:, :0])


def test_on_the_way_it_commands_what_was_planned(pilot):
    way, step = pilot.way, slice(0, 1)
    action = pilot(seen(way.position[step], way.velocity[step], way.rotation[step]))
    thrust = 9.81 + (COARSE.thrust - 9.81) * action[:, 0]
    torch.testing.assert_close(thrust, way.command[step, 0], rtol=1e-3, atol=1e-2)
    assert bool((action.abs() <= 1.0).all())


@given(seed=st.integers(0, 10**6), size=st.integers(1, 8))
@settings(max_examples=25)
def test_the_least_within_bounds_is_that_of_scipy(seed, size):
    random = np.random.default_rng(seed)
    root, slope = random.normal(size=(size + 2, size)), random.normal(size=size)
    hessian = root.T @ root + 0.1 * np.eye(size)
    least, most = -random.uniform(0.0, 1.0, size), random.uniform(0.0, 1.0, size)
    weight = float(np.diag(hessian).mean())
    regularised = torch.tensor(np.linalg.inv(hessian + weight * np.eye(size)))[None]
    rows = [torch.tensor(part)[None] for part in (slope, least, most)]
    found = bounded_least(regularised, weight, rows[0], (rows[1], rows[2]), 3000)[0].numpy()
    upper = np.linalg.cholesky(hessian).T
    exact = lsq_linear(upper, -np.linalg.solve(upper.T, slope), (least, most), tol=1e-14).x
    np.testing.assert_allclose(found, exact, atol=1e-5)


@pytest.mark.slow
def test_a_race_is_flown_as_fast_as_it_was_planned(pilot):
    laps = fly_laps(racing(4, settings=SETTINGS), pilot, seed=0, laps=2, seconds=15.0)
    metrics = laps.metrics()
    assert metrics["laps_completed"] == 1.0
    assert metrics["mean_lap"] == pytest.approx(pilot.way.lap * COARSE.period, rel=0.03)
