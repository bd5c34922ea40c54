"""A race in a simulator that a learned model moves."""

import pytest
import torch

from simgap.errors import InputError
from simgap.models.simulated import LearnedMotion
from simgap.physics import rotations
from simgap.policies.racing.flying import PARTS, Fleet, flight_in
from simgap.policies.racing.racing import Racing
from simgap.policies.racing.settings import Flying, RacingSettings
from simgap.simulation import Simulator
from tests.pipeline.gates.tracks import track_named
from tests.pipeline.models import learnable
from tests.pipeline.policies.environment_contract import check_contract
from tests.pipeline.policies.racing.machines import racer

FLYING = Flying(period=0.02)  # two steps of the recording


@pytest.fixture(scope="module")
def simulator():
    recorded = learnable.quadrotor()
    train, validation, _ = learnable.parts_of(recorded)
    model = learnable.new_model("linear", recorded)
    model.fit(train, validation, learnable.QUICK)
    return Simulator(racer(), learned=LearnedMotion(model, racer()))


@pytest.mark.parametrize("powertrain", [True, False])
def test_it_keeps_to_the_contract_of_an_environment(simulator, powertrain):
    settings = RacingSettings(flying=Flying(period=0.02, powertrain=powertrain))
    flight = flight_in(simulator, settings.flying)
    check_contract(Racing(flight, track_named("tiny"), settings, 4), steps=8)


def test_the_model_moves_the_machines_and_not_the_physics(simulator):
    flight = flight_in(simulator, FLYING)
    fleet = Fleet(flight)
    state = torch.zeros(3, 13)
    state[:, PARTS["attitude"]] = rotations.from_rotation_vector(0.1 * torch.eye(3))
    command = torch.tensor([[9.81, 1.0, 0.0, 0.0]]).expand(3, -1)
    flown = fleet.step(fleet.rows(state), command)
    by_hand, _ = flight.step(state, command, (None, fleet._remembering(state)))
    physics, _ = flight_in(Simulator(racer()), FLYING).step(state, command)
    assert flight.substeps == 2
    # The rate controller has seen a hover before, by hand it has seen nothing.
    assert torch.allclose(flown[:13].T, by_hand, atol=1e-3)
    assert not torch.allclose(flown[:13].T, physics, atol=2e-3)


def test_a_period_between_the_steps_of_the_model_is_refused(simulator):
    with pytest.raises(InputError, match=r"is no multiple of the 0\.01 s"):
        flight_in(simulator, Flying(period=0.015))
