"""A force that a simulator lacks is found in a recording, becomes a part of the simulator, and is flown."""

import numpy as np
import pytest
import torch

from simgap.effects import effect_by_key
from simgap.errors import InputError
from simgap.plants.case import PlantCase, Sensors
from simgap.plants.fly import fly
from simgap.platforms import Joint
from simgap.policies.racing.flying import PARTS, Fleet, flight_in
from simgap.policies.residual.accelerations import left_over, nearest_of
from simgap.recordings.cleaning import clean_recording
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.dataset import Dataset
from simgap.simulation import FittedEffect, Simulator, read_simulator, write_simulator
from simgap.simulation.knn_residual import commanded_thrust
from simgap.simulation.motion import QuadrotorMotion
from tests.pipeline.policies.racing.machines import COARSE, racer

DRAG = 0.5


@pytest.fixture(scope="module")
def recording():
    case = PlantCase(effects={"rotor_drag": DRAG}, runs=3, duration=6.0, sensors=Sensors(scale=0.3))
    recorded, _ = fly(case, racer(), seed=0)
    return clean_recording(recorded, Cleaning(), Dataset().split, 0)[0]


def typical(recording):
    """Return a state and a command as they were recorded, at some speed: (1, 13) and (1, 4)."""
    frame = recording.frame
    speed = np.hypot(frame["velocity_x"], frame["velocity_y"]).to_numpy()
    row = frame.iloc[int(np.argsort(speed)[int(0.8 * len(speed))])]
    names = {"position": "xyz", "attitude": "wxyz", "velocity": "xyz", "body_rate": "xyz"}
    state = torch.zeros(1, 13)
    for name, axes in names.items():
        state[0, PARTS[name]] = torch.tensor([row[f"{name}_{axis}"] for axis in axes])
    command = torch.tensor([[row[f"motor_command_{rotor}"] for rotor in range(1, 5)]])
    thrust = float(commanded_thrust({"motor_command": command}, racer()))
    return state, torch.tensor([[thrust, *state[0, PARTS["body_rate"]]]])


def with_residual(recording, simulator):
    features, residual = left_over(simulator, recording, width=0.1)
    nearest = nearest_of(features, residual, samples=800, count=5, platform=simulator.platform)
    return simulator.with_effects((*simulator.effects, FittedEffect(nearest, {}, known=True)))


def test_what_is_left_over_is_the_drag(recording):
    features, residual = left_over(Simulator(racer()), recording, width=0.1)
    lateral, velocity = residual[:, :2].flatten(), features[:, :2].flatten()
    slope = float((lateral * velocity).sum() / velocity.square().sum())
    assert slope == pytest.approx(-DRAG, rel=0.1)


def test_a_simulator_that_knows_the_drag_leaves_less_over(recording):
    drag = FittedEffect(effect_by_key("quadrotor", "rotor_drag"), {"coefficient": DRAG})
    bare, knowing = (
        left_over(simulator, recording, width=0.1)[1].square().mean(0).sqrt()
        for simulator in (Simulator(racer()), Simulator(racer(), (drag,)))
    )
    assert (knowing[:2] < 0.35 * bare[:2]).all()


def test_the_residual_is_part_of_a_simulator_that_is_read_as_it_was_written(recording, tmp_path):
    simulator = with_residual(recording, Simulator(racer()))
    write_simulator(simulator, tmp_path)
    read = read_simulator(tmp_path)
    state, reference = typical(recording)
    signals = QuadrotorMotion().signals(state)
    speed = (reference[:, :1] * racer().mass / 4.0 / racer().thrust_coefficient).sqrt().expand(1, 4)
    signals["rotor_speed"] = speed
    ours, theirs = (one.wrench(signals, one.constants()) for one in (simulator, read))
    assert all(torch.equal(ours[name], theirs[name]) for name in ours)
    lateral = torch.stack([ours["force_x"], ours["force_y"]], -1)
    torch.testing.assert_close(lateral, -DRAG * signals["velocity"][:, :2], rtol=0.3, atol=0.3)
    (tmp_path / "recorded_residual.safetensors").write_bytes(b"other")
    with pytest.raises(InputError, match="is not the file"):
        read_simulator(tmp_path)


@pytest.mark.slow
def test_a_policy_feels_it(recording):
    state, reference = typical(recording)
    simulators = (Simulator(racer()), with_residual(recording, Simulator(racer())))
    ends = []
    for simulator in simulators:
        fleet = Fleet(flight_in(simulator, COARSE))
        rows = fleet.rows(state)
        for _ in range(10):
            rows = fleet.step(rows, reference)
        ends.append(rows[PARTS["velocity"]].T)
    moved = ends[1] - ends[0]
    expected = -DRAG * 10 * COARSE.period * state[:, PARTS["velocity"]]
    torch.testing.assert_close(moved[:, :2], expected[:, :2], rtol=0.4, atol=0.05)


def test_only_quadrotors_have_it(recording):
    with pytest.raises(InputError, match="choose a quadrotor"):
        left_over(Simulator(Joint(inertia=1.0)), recording, width=0.1)
