"""The time-optimal plan is flown as fast as it was planned."""

import numpy as np
import pytest
import torch
from scipy.optimize import lsq_linear

from pipeline.policies.environment import Observation
from pipeline.policies.racing.laps import fly_laps
from pipeline.policies.racing.model_predictive import time_optimal_pilot
from pipeline.policies.racing.settings import RacingSettings, Starts
from tests.pipeline.policies.racing.machines import COARSE, racing, track_named

CALM = Starts(position=0.1, velocity=0.1, attitude=0.02, body_rate=0.1)
SETTINGS = RacingSettings(flying=COARSE, starts=CALM)


@pytest.fixture(scope="module")
def pilot():
    return time_optimal_pilot(track_named("tiny"), SETTINGS, gravity=9.81)


def seen(position, velocity, rotation):
    """Return what is seen in a state, as far as the pilot looks at it."""
    turn = rotation.flatten(1)
    return Observation(torch.cat([position / 10.0, velocity / 10.0, turn], dim=1), turn[:, :0])


def test_on_the_way_it_commands_what_was_planned(pilot):
    way, step = pilot._way, slice(0, 1)
    pilot._place = None
    action = pilot(seen(way.position[step], way.velocity[step], way.rotation[step]))
    planned = way.command[step]
    thrust = 9.81 + (COARSE.thrust - 9.81) * action[:, 0]
    torch.testing.assert_close(thrust, planned[:, 0], rtol=1e-3, atol=1e-2)
    assert bool((action.abs() <= 1.0).all())


def test_commands_are_the_best_within_the_bounds(pilot):
    """Against SciPy's solver for least squares with bounds, on a large error that meets them."""
    place = torch.tensor([5])
    error = torch.tensor([[0.5, -0.4, 0.2, 2.0, -1.0, 0.5, 0.2, -0.1, 0.1]])
    inverse, slope = pilot._inverse[place[0]].double(), pilot._slope[place[0]].double()
    size = len(inverse)
    hessian = torch.linalg.inv(inverse) - pilot._weight * torch.eye(size, dtype=torch.float64)
    root = torch.linalg.cholesky(hessian + 1e-9 * torch.eye(size, dtype=torch.float64)).T
    wanted = -torch.linalg.solve_triangular(root.T, slope @ error[0].double()[:, None], upper=False)[:, 0]
    planned = pilot._way.command[pilot._way.after(place + torch.arange(size // 4))].double()
    bounds = [(limit.double() - planned).flatten().numpy() for limit in (pilot._least, pilot._most)]
    exact = lsq_linear(root.numpy(), wanted.numpy(), (bounds[0] - 1e-9, bounds[1] + 1e-9)).x[:4]
    np.testing.assert_allclose(pilot._solved(place, error)[0].numpy(), exact, atol=0.3)


def test_a_race_is_flown_as_fast_as_it_was_planned(pilot):
    pilot._place = None
    laps = fly_laps(racing(4, settings=SETTINGS), pilot, seed=0, laps=2, seconds=15.0)
    metrics = laps.metrics()
    assert metrics["laps_completed"] == 1.0
    planned = pilot._way.lap * COARSE.period
    assert metrics["mean_lap"] == pytest.approx(planned, rel=0.03)
