from dataclasses import replace

import pytest
import torch

from simgap.policies.racing.entry import (
    described_race,
    gone_on_with,
    race_from,
    race_in,
    trained_race,
)
from simgap.policies.racing.flying import PARTS
from simgap.policies.racing.passage import passage
from simgap.policies.racing.settings import RacingSettings, Randomisation, Reward, Starts
from simgap.policies.racing.time_optimal import Limits, optimal_lap
from simgap.simulation import Simulator
from tests.pipeline.gates.tracks import track_named, track_settings
from tests.pipeline.policies.environment_contract import check_contract
from tests.pipeline.policies.racing.machines import COARSE, racer

PLANNED = RacingSettings(flying=COARSE, starts=Starts(kept=48, planned=0.25))


@pytest.fixture(scope="module")
def environment():
    return race_in(Simulator(racer()), track_settings("tiny"), PLANNED, 32)


def test_racing_from_planned_starts_keeps_to_the_contract(environment):
    check_contract(environment, steps=40)


def test_machines_start_all_along_the_time_optimal_lap(environment):
    environment.start(0)
    track, planned = track_named("tiny"), environment.state["starts"][:, 12:24]
    lap = optimal_lap(track, Limits.of(COARSE), racer().gravity)
    flown = torch.from_numpy(lap.states[:-1]).float()
    torch.testing.assert_close(planned.flatten(0, 1).roll(12, 0), flown, atol=1e-4, rtol=1e-4)
    assert bool((planned[..., PARTS["velocity"]].norm(dim=-1) > PLANNED.starts.speed).all())


def test_straight_on_they_leave_the_gate_behind_and_pass_the_next(environment):
    environment.start(0)
    track, planned = track_named("tiny"), environment.state["starts"][:, 12:24]
    for gate in range(len(track)):
        position, step = planned[gate, :, PARTS["position"]], 0.05 * planned[gate, :, PARTS["velocity"]]
        behind = passage(track, position[:1] - step[:1], position[:1] + step[:1], torch.tensor([gate]))
        ahead = passage(
            track, position[-1:], position[-1:] + 6 * step[-1:], torch.tensor([(gate + 1) % len(track)])
        )
        assert bool(behind.passed.all())
        assert bool(ahead.passed.all())


def test_a_race_is_flown_without_them_and_a_training_goes_on_with_them():
    described = described_race(track_settings("tiny"), PLANNED)
    assert trained_race(described)[1] == PLANNED
    assert race_from(described, powertrain=None)[1].starts == replace(PLANNED.starts, planned=0.0)


def test_where_a_policy_is_trained_further_a_crash_costs_what_it_did_in_the_end():
    drawn = replace(PLANNED, reward=Reward(first_crash=2.0), randomisation=Randomisation(drag=0.3))
    again, still = (gone_on_with(drawn, randomised) for randomised in (False, True))
    assert again.reward == still.reward == Reward()
    assert (again.starts.planned, again.randomisation) == (0.0, Randomisation())
    assert (still.starts, still.randomisation) == (drawn.starts, drawn.randomisation)


def test_where_a_policy_is_trained_further_thrust_differs_as_much_as_asked_for_at_least():
    drawn = replace(PLANNED, randomisation=Randomisation(drag=0.3, thrust=0.1))
    assert gone_on_with(drawn, False, thrust=0.08).randomisation == Randomisation(thrust=0.08)
    assert gone_on_with(drawn, True, thrust=0.08).randomisation == drawn.randomisation
