"""The concealed machine, raced by the flight controller that the simulator has."""

import numpy as np
import pytest
import torch

from simgap.plants.case import PlantCase, Sensors
from simgap.plants.estimator import Aid
from simgap.plants.race import RacedMachines
from simgap.policies.racing.deployed import Deployed, RateLoop
from simgap.policies.racing.flying import PARTS, Fleet, flight_in, state_of
from simgap.policies.racing.settings import Flying
from simgap.simulation import Simulator
from tests.pipeline.policies.racing.machines import racer

RACER = racer()
FLYING = Flying(powertrain=False)
MACHINES = 3
QUIET = Sensors(scale=0.0)


def raced(seed=0, aid=None, **case):
    loop = RateLoop(RACER, FLYING.time_constant, RacedMachines.step)
    return RacedMachines(PlantCase(**case), RACER, loop, MACHINES, seconds=2.0, seed=seed, aid=aid)


def deployed(seed=0, **case):
    machines = raced(seed, **case)
    return Deployed(lambda state, reference: machines.fly(state, reference, FLYING.period))


def level() -> torch.Tensor:
    state = torch.zeros(MACHINES, 13)
    state[:, 3] = 1.0
    return state


def flown(machines, steps=40):
    """Roll to and fro under more than hover thrust, each machine by another rate."""
    rows, path = machines.rows(level()), []
    rates = torch.tensor([0.5, -1.0, 2.0])
    for step in range(steps):
        command = torch.zeros(MACHINES, 4)
        command[:, 0] = 11.0
        command[:, 1] = rates * (1.0 if step < steps // 2 else -1.0)
        rows = machines.step(rows, command)
        path.append(state_of(rows))
    return {name: torch.stack([entry[name] for entry in path]) for name in path[0]}


@pytest.mark.slow
def test_a_machine_that_conceals_nothing_flies_as_in_the_ideal_simulator():
    ours, theirs = flown(Fleet(flight_in(Simulator(RACER), FLYING))), flown(deployed(sensors=QUIET))
    torch.testing.assert_close(theirs["position"], ours["position"], rtol=0, atol=5e-3)
    torch.testing.assert_close(theirs["attitude"], ours["attitude"], rtol=0, atol=2e-2)


def test_what_is_concealed_is_felt():
    drag = flown(deployed(sensors=QUIET, effects={"rotor_drag": 0.5}))
    still = flown(deployed(sensors=QUIET))
    slower = drag["velocity"][-1].norm(dim=-1) / still["velocity"][-1].norm(dim=-1)
    assert (slower[2] < 0.98).all()


def test_flights_are_those_of_their_seed():
    once, again, other = (flown(deployed(seed), 10)["body_rate"] for seed in (1, 1, 2))
    assert torch.equal(once, again)
    assert not torch.equal(once, other)


def test_machines_without_an_estimator_know_where_they_are_and_others_believe_something_else():
    for estimates, most in ((0.0, 0.0), (1.0, 0.5)):
        machines = deployed(estimates=estimates)
        rows = machines.rows(level())
        for _ in range(40):
            rows = machines.step(rows, torch.tensor([[12.0, 1.0, 0.0, 0.0]]).expand(MACHINES, 4))
        wrong = (machines.believed(rows)[PARTS["position"]] - rows[PARTS["position"]]).norm(dim=0)
        assert float(wrong.max()) <= most
        assert bool((wrong > 0.0).all()) == (estimates > 0.0)


def estimates_of(aid, calls=60):
    """Return what the machines know of where they are on their way straight ahead, one by one."""
    machines = raced(aid=aid, estimates=1.0)
    state = np.tile([0.0, 0.0, 2.0, 8.0, 0.0, 0.0, 1.0, *[0.0] * 6], (MACHINES, 1))
    for _ in range(calls):
        state, _ = machines.fly(state, np.tile([RACER.gravity, 0.0, 0.0, 0.0], (MACHINES, 1)), FLYING.period)
    return [machines.estimates(np.tile(run, (calls, 1))) for run in np.eye(MACHINES, dtype=bool)]


def test_machines_that_see_a_gate_know_better_where_they_are():
    sights = iter(range(1000))
    look = lambda _: np.array([[2.0], [2.0 if next(sights) % 2 else np.inf], [np.inf]])  # noqa: E731
    seen = estimates_of(Aid(look))
    assert [each["gate_in_view"] for each in seen] == pytest.approx([1.0, 0.5, 0.0], abs=0.1)
    assert max(each["position_error"] for each in seen[:2]) < seen[2]["position_error"]


def test_machines_without_a_camera_see_nothing_and_are_off_all_the_same():
    for each in estimates_of(None, calls=10):
        assert set(each) == {"position_error"}
        assert each["position_error"] > 0.0


@pytest.mark.parametrize("rate", [0.0, 3.0])
def test_the_rate_loop_asks_the_rotors_for_what_the_mixer_says(rate):
    loop = RateLoop(RACER, 0.033, 1e-3)
    body_rate = np.tile([rate, 0.0, 0.0], (2, 1))
    speed = loop(body_rate, np.tile([RACER.gravity, rate, 0.0, 0.0], (2, 1)))
    np.testing.assert_allclose(speed, RACER.hover_rotor_speed, rtol=1e-6)
