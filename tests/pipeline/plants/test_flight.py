import numpy as np
import pytest
import torch

from simgap.physics import rigid_body, rotations, rotors
from simgap.physics.integrators import rk4
from simgap.plants.battery import Battery
from simgap.plants.case import PlantCase, Sensors
from simgap.plants.design import design
from simgap.plants.dither import shake
from simgap.plants.flight import SETTLING, fly_paths
from simgap.plants.path import plan

QUIET = Sensors(scale=0.0)


def flight(racer, step=1e-3, **kwargs):
    case = PlantCase(runs=3, duration=1.0, sensors=QUIET, **kwargs)
    random = np.random.default_rng(1)
    paths, dither = plan(case, random), shake(case, random)
    battery = Battery(racer, np.ones(3))
    return fly_paths(design(racer, case), racer, case, paths, dither, battery, random, step), paths


def test_with_everything_off_it_moves_as_the_nominal_rigid_body(racer):
    """Replay the logged rotor speeds in `simgap.physics`, by another integrator at another step."""
    log, _ = flight(racer)
    start, stride = round(SETTLING / log.step), 4
    mass, inertia = racer.mass, torch.tensor(racer.inertia, dtype=torch.float64)
    positions = torch.tensor(racer.rotor_positions, dtype=torch.float64)
    directions = torch.tensor(racer.rotor_directions, dtype=torch.float64)

    def derivative(state, speed):
        velocity, attitude, body_rate = state[..., 3:6], state[..., 6:10], state[..., 10:]
        reaction = rotors.reaction_torque(speed, racer.torque_coefficient, directions)
        force, torque = rotors.wrench(rotors.thrust(speed, racer.thrust_coefficient), reaction, positions)
        return torch.cat(
            (
                velocity,
                rigid_body.linear_acceleration(attitude, force / mass, racer.gravity),
                rotations.quaternion_derivative(attitude, body_rate),
                rigid_body.angular_acceleration(body_rate, torque, inertia),
            ),
            dim=-1,
        )

    truth = np.concatenate((log.position, log.velocity, log.attitude, log.body_rate), axis=-1)
    state = torch.from_numpy(truth[start])
    for index in range(start, start + 400, stride):
        speeds = torch.from_numpy(log.rotor_speed[index : index + stride + 1]).mean(dim=0)
        state = rk4(lambda x, speeds=speeds: derivative(x, speeds), state, stride * log.step)
    np.testing.assert_allclose(state, truth[start + 400], atol=2e-3)


def test_the_integrator_is_of_second_order(racer, monkeypatch):
    """The same closed loop at halved steps, its discrete filter aside: the change falls by four."""
    monkeypatch.setattr("simgap.plants.flight._GYRO_CUT_OFF", np.inf)
    ends = []
    for step in (5e-3, 2.5e-3, 1.25e-3):
        log, _ = flight(racer, step, effects={"rotor_drag": 0.4})
        ends.append(np.concatenate((log.position[-1], log.velocity[-1], log.attitude[-1]), axis=-1))
    coarse, fine = np.linalg.norm(ends[0] - ends[1]), np.linalg.norm(ends[1] - ends[2])
    assert coarse / fine == pytest.approx(4.0, rel=0.25)


def test_paths_are_followed(racer):
    log, paths = flight(racer, effects={"rotor_drag": 0.4, "axial_inflow": 0.3, "mass_error": 1.1})
    times = np.arange(len(log.position)) * log.step - SETTLING
    error = np.linalg.norm(paths.at(times)[0][..., :3] - log.position, axis=-1)
    assert error[times > 0].max() < 0.8


def test_rotor_speeds_are_those_that_the_motors_can_have(racer):
    log, _ = flight(racer)
    assert log.rotor_speed.min() > 0
    assert log.rotor_speed.max() <= racer.motor_speed_max
    np.testing.assert_array_equal(log.rotor_speed, log.rotor_command)


def test_motor_lag_delays_the_speed_by_its_time_constant(racer):
    log, _ = flight(racer, effects={"motor_lag": 0.04})
    rate = np.gradient(log.rotor_speed, log.step, axis=0)
    behind = log.rotor_command - log.rotor_speed
    estimated = (behind**2).sum(axis=(0, 1)) / (behind * rate).sum(axis=(0, 1))
    assert estimated.mean() == pytest.approx(0.04, rel=0.15)
    assert np.ptp(estimated) > 1e-4  # each rotor has its own
