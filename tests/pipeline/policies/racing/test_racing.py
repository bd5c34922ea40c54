from dataclasses import replace

import pytest
import torch

from simgap.effects import effect_by_key
from simgap.errors import InputError
from simgap.platforms import Joint
from simgap.policies.racing.flying import PARTS, Fleet, flight_in, left_out, state_of
from simgap.policies.racing.observation import seen_state
from simgap.policies.racing.racing import commanded
from simgap.policies.racing.settings import Flying, RacingSettings, Reward
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.driver import SimulatedDriver
from tests.pipeline.policies.environment_contract import check_contract
from tests.pipeline.policies.racing.machines import COARSE, racer, racing

SAG = effect_by_key("quadrotor", "battery_sag")


@pytest.fixture(scope="module")
def environment():
    return racing(64)


def put(environment, position, velocity, target: int) -> None:
    """Put all machines, level, at one place."""
    states = torch.zeros(environment.batch, 13)
    states[:, PARTS["position"]] = torch.tensor(position)
    states[:, PARTS["attitude"].start] = 1.0
    states[:, PARTS["velocity"]] = torch.tensor(velocity)
    machines = torch.arange(environment.batch)
    environment.place(machines, states, torch.full((environment.batch,), target))


def test_racing_keeps_to_the_contract(environment):
    check_contract(environment, steps=60)


class Shifted:
    """The first function moves what is believed along x, the second along y; both lift it by 0.1 m/s."""

    def __len__(self) -> int:
        return 2

    def __call__(
        self, state: dict[str, torch.Tensor], moments: torch.Tensor, which: torch.Tensor
    ) -> dict[str, torch.Tensor]:
        along, moving = torch.eye(3)[which], 0.1 * torch.eye(3)[2] * moments[:, None]
        return {**state, "position": state["position"] + along + moving}


def test_machines_that_misjudge_their_states_keep_to_the_contract():
    check_contract(racing(16, misjudging=Shifted()), steps=30)


def test_a_policy_sees_what_is_believed_and_its_critic_the_truth_besides(environment):
    misjudging = racing(64, misjudging=Shifted())
    for one in (environment, misjudging):
        one.start(0)
        put(one, [4.0, -3.0, 2.5], [0.0, 8.0, 0.0], target=0)
    truth, belief = environment.observe(), misjudging.observe()
    which = misjudging.state["misjudged"]
    assert set(which.tolist()) == {0, 1}
    torch.testing.assert_close(seen_state(belief)[0] - seen_state(truth)[0], torch.eye(3)[which])
    assert torch.equal(belief.privileged, truth.privileged)
    assert not bool(misjudging.step(torch.zeros(64, 4)).terminated.any())
    assert torch.equal(misjudging.state["misjudged"], which)  # through the whole flight
    seen, true = seen_state(misjudging.observe())[0], state_of(misjudging.state["rows"])["position"]
    moved = seen - true - torch.eye(3)[which]
    torch.testing.assert_close(moved[:, 2], torch.full((64,), 0.1 * misjudging.period), rtol=0, atol=1e-5)


def test_an_action_of_zero_hovers(environment):
    environment.start(0)
    put(environment, [0.0, 0.0, 2.5], [0.0, 0.0, 0.0], target=0)
    for _ in range(50):
        environment.step(torch.zeros(environment.batch, 4))
    state = state_of(environment.state["rows"])
    assert float((state["position"][:, :2]).abs().max()) < 1e-3
    # The throttle is calibrated at the nominal voltage; a full battery lifts a little.
    assert 0.0 <= float((state["position"][:, 2] - 2.5).max()) < 0.3
    assert not bool(environment.crashed.any())


def test_a_machine_that_flies_through_its_gate_is_sent_to_the_next_and_remembered(environment):
    environment.start(0)
    put(environment, [4.0, -0.05, 2.5], [0.0, 8.0, 0.0], target=0)
    before = environment.state["starts"].clone()
    environment.measures()
    transition = environment.step(torch.zeros(environment.batch, 4))
    assert not bool(transition.terminated.any())
    assert environment.state["target"].tolist() == [1] * environment.batch
    changed = (environment.state["starts"] != before).any(-1).any(-1)
    assert changed.tolist() == [True, False, False, False]
    per_second = environment.measures()
    assert per_second == {"gates_per_second": pytest.approx(100.0), "crashes_per_second": 0.0}


def test_a_machine_that_hits_the_frame_or_the_ground_ends_with_the_penalty(environment):
    environment.start(0)
    for position, velocity in (([2.4, -0.05, 2.5], [0.0, 8.0, 0.0]), ([0.0, 0.0, 0.2], [0.0, 0.0, -8.0])):
        put(environment, position, velocity, target=0)
        transition = environment.step(torch.zeros(environment.batch, 4))
        assert bool(transition.terminated.all())
        assert bool((transition.reward < -4.0).all())
        assert environment.state["age"].tolist() == [0] * environment.batch


def test_episodes_start_at_every_gate_with_the_next_one_ahead(environment):
    environment.start(0)
    state, target = state_of(environment.state["rows"]), environment.state["target"]
    assert set(target.tolist()) == {0, 1, 2, 3}
    passed = environment.track.centres[(target - 1) % 4]
    assert float((state["position"] - passed).abs().max()) <= environment.settings.starts.position + 1e-5


def test_the_fleet_flies_as_the_flight_does():
    flight = flight_in(Simulator(racer()), COARSE)
    fleet = Fleet(flight)
    states = racing_states(40)
    command = torch.cat([torch.full((40, 1), 12.0), 0.5 * torch.randn(40, 3)], dim=1)
    rows = fleet.rows(states)
    state, memory = fleet._step.unpack(rows)
    for _ in range(3):
        rows = fleet.step(rows, command)
        state, memory = flight.step(state, command, memory)
    torch.testing.assert_close(rows[:13].T, state, rtol=1e-4, atol=1e-4)


def racing_states(batch: int) -> torch.Tensor:
    states = torch.randn(batch, 13, generator=torch.Generator().manual_seed(0))
    states[:, 3:7] /= states[:, 3:7].norm(dim=-1, keepdim=True)
    return states


def test_a_command_goes_from_nothing_to_the_greatest_thrust():
    settings = Flying(thrust=30.0, rate=5.0, yaw_rate=2.0)
    actions = torch.tensor([[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, -1.0, 1.0]])
    expected = torch.tensor([[0.0, 0.0, 0.0, 0.0], [9.81, 5.0, 0.0, 0.0], [30.0, 0.0, -5.0, 2.0]])
    torch.testing.assert_close(commanded(actions, settings, 9.81), expected)


def test_a_crash_costs_more_when_more_of_the_training_is_done():
    environment = racing(2, settings=RacingSettings(flying=COARSE, reward=Reward(crash=5.0, first_crash=2.0)))
    environment.start(0)
    rewards = []
    for share in (0.0, 1.0):
        environment.schedule(share)
        put(environment, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), target=0)
        transition = environment.step(torch.zeros(2, 4))
        assert bool(transition.terminated.all())
        rewards.append(transition.reward)
    torch.testing.assert_close(rewards[0] - rewards[1], torch.full((2,), 3.0))


def test_what_cannot_race_is_refused():
    with pytest.raises(InputError, match="joint cannot race"):
        flight_in(Simulator(Joint(inertia=1.0)), Flying())
    with pytest.raises(InputError, match="no parameter"):
        flight_in(Simulator(racer()), Flying(effects={"rotor_drag": {"nothing": 1.0}}))


def test_without_a_battery_what_it_drives_is_left_out_and_said():
    """A diagnosis may name battery_sag, and a policy be trained without a powertrain of the project's own."""
    flying = replace(COARSE, powertrain=False)
    sagging = Simulator(racer(), (FittedEffect(SAG, {"sensitivity": 0.8}),))
    (said,) = left_out(sagging, flying)
    assert "battery_sag" in said
    assert "battery_voltage" in said
    torch.testing.assert_close(*(hovered(each, flying) for each in (sagging, Simulator(racer()))))
    assert not left_out(sagging, COARSE)


def test_a_battery_as_it_was_recorded_is_flown():
    """Two thirds of the nominal voltage leave less than half of the thrust."""
    flying = replace(COARSE, powertrain=False)
    level = FittedEffect(SimulatedDriver(SAG), {"level": 10.0, "giving": 0.0}, known=True)
    sagging = Simulator(racer(), (FittedEffect(SAG, {"sensitivity": 1.0}), level))
    assert not left_out(sagging, flying)
    upward = [
        hovered(each, flying)[0, PARTS["velocity"]][2] + 9.81 * flying.period
        for each in (sagging, Simulator(racer()))
    ]
    assert float(upward[0] / upward[1]) == pytest.approx((10.0 / racer().nominal_voltage) ** 2, rel=0.01)


def hovered(simulator: Simulator, flying: Flying) -> torch.Tensor:
    """Return the states (2, 13) after one period of commands near hover."""
    state = torch.zeros(2, 13)
    state[:, PARTS["attitude"].start] = 1.0
    command = torch.tensor([[12.0, 0.0, 0.0, 0.0]]).expand(2, 4)
    return flight_in(simulator, flying).step(state, command)[0]
