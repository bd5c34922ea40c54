from dataclasses import replace

import pytest
import torch

from simgap.policies.racing.entry import described_race, race_from, race_in, trained_race
from simgap.policies.racing.flying import state_of
from simgap.policies.racing.randomisation import drawn_episode, drawn_wrench
from simgap.policies.racing.settings import RacingSettings, Randomisation
from simgap.simulation import Simulator
from tests.pipeline.gates.tracks import track_settings
from tests.pipeline.policies.environment_contract import check_contract
from tests.pipeline.policies.racing.machines import COARSE, racer
from tests.pipeline.policies.racing.test_racing import put

BOUNDS = Randomisation(drag=0.5, thrust=0.1, angular_acceleration=3.0)
DRAWING = RacingSettings(flying=COARSE, randomisation=BOUNDS)


@pytest.fixture(scope="module")
def environment():
    return race_in(Simulator(racer()), track_settings("tiny"), DRAWING, 32)


def test_what_is_drawn_stays_within_its_bounds_and_fills_them():
    drawn = drawn_episode(4000, BOUNDS, torch.Generator().manual_seed(0))
    low, high = drawn.amin(0), drawn.amax(0)
    bounds = torch.tensor([0.5, 0.5, 0.5, 0.1, 3.0, 3.0, 3.0])
    assert bool((high <= bounds).all())
    assert bool((high > 0.99 * bounds).all())
    torch.testing.assert_close(low, torch.cat([torch.zeros(3), -bounds[3:]]), atol=0.02, rtol=0.01)


def test_drag_takes_energy_and_thrust_is_in_proportion():
    drawn = drawn_episode(100, replace(BOUNDS, thrust=0.0), torch.Generator().manual_seed(0))
    features = torch.randn(100, 7, generator=torch.Generator().manual_seed(1))
    wrench = drawn_wrench(drawn, features, torch.ones(3))
    assert bool(((wrench[:, :3] * features[:, :3]).sum(-1) < 0).all())
    lifting = torch.tensor([[0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 2.0]])
    hovering = torch.tensor([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.81]])
    expected = torch.tensor([[0.0, 0.0, 0.981, 0.0, 0.0, 0.01]])
    torch.testing.assert_close(drawn_wrench(lifting, hovering, torch.tensor([0.1, 0.1, 0.005])), expected)


@pytest.mark.slow
def test_racing_with_what_is_drawn_keeps_to_the_contract(environment):
    check_contract(environment, steps=40)


def test_machines_with_different_draws_fly_differently(environment):
    environment.start(0)
    put(environment, [0.0, 0.0, 2.5], [3.0, 0.0, 0.0], target=0)
    environment.state["drawn"][:16] = 0.0
    for _ in range(10):
        environment.step(torch.zeros(32, 4))
    velocity = state_of(environment.state["rows"])["velocity"]
    assert float((velocity[:16] - velocity[:1]).abs().max()) < 1e-5
    assert bool(((velocity[16:] - velocity[:1]).norm(dim=-1) > 1e-3).all())


def test_a_policy_is_evaluated_without_what_was_drawn_in_its_training():
    described = described_race(track_settings("tiny"), DRAWING)
    track, settings = race_from(described, powertrain=None)
    assert track == track_settings("tiny")
    assert settings == RacingSettings(flying=COARSE)
    assert race_from(described, powertrain=False)[1].flying == replace(COARSE, powertrain=False)


def test_it_can_be_trained_further_with_it():
    described = described_race(track_settings("tiny"), DRAWING)
    assert trained_race(described) == (track_settings("tiny"), DRAWING)
