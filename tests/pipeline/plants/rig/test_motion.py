import numpy as np
import pytest

from simgap.plants.integration import AdamsBashforth
from simgap.plants.rig.bearings import Bearings, inertia_with
from simgap.plants.rig.case import Gimbal, RigCase
from simgap.plants.rig.motion import Autopilot, derivative
from simgap.plants.rotation import matrix

LEVEL = np.eye(3)[None]
MOMENTS = np.array([3e-3, 2.5e-3, 5e-3])


def body_at(rate):
    state = np.zeros((1, 13))
    state[:, 6], state[:, 10:] = 1.0, rate
    return state


def test_a_body_left_alone_keeps_its_energy_and_its_momentum():
    gimbal = Gimbal(rings=[3e-4, 6e-4, 9e-4], skew=0.2)
    inertia, advance, state = inertia_with(gimbal, MOMENTS), AdamsBashforth(1e-3), body_at([2.0, -1.0, 3.0])
    energies, momenta = [], []
    for _ in range(2000):
        momentum = state[0, 10:] @ inertia
        energies.append(0.5 * state[0, 10:] @ momentum)
        momenta.append(matrix(state[:, 6:10])[0] @ momentum)
        state = advance(state, derivative(state, np.zeros((1, 3)), inertia))
        state[:, 6:10] /= np.linalg.norm(state[:, 6:10])
    np.testing.assert_allclose(energies, energies[0], rtol=1e-4)
    np.testing.assert_allclose(
        momenta, np.tile(momenta[0], (2000, 1)), atol=1e-3 * np.linalg.norm(momenta[0])
    )
    assert (state[:, :6] == 0.0).all()


def test_a_hanging_body_is_drawn_back_to_the_level():
    bearings = Bearings(Gimbal(hanging=0.01), weight=10.0, runs=1, step=1e-3)
    np.testing.assert_allclose(bearings(LEVEL, np.zeros((1, 3))), 0.0, atol=1e-15)
    tilt = 0.3
    rolled = np.array(
        [[[1.0, 0.0, 0.0], [0.0, np.cos(tilt), -np.sin(tilt)], [0.0, np.sin(tilt), np.cos(tilt)]]]
    )
    np.testing.assert_allclose(
        bearings(rolled, np.zeros((1, 3))), [[-0.1 * np.sin(tilt), 0.0, 0.0]], atol=1e-15
    )
    forward = Bearings(Gimbal(sideways=0.01), weight=10.0, runs=1, step=1e-3)
    np.testing.assert_allclose(forward(LEVEL, np.zeros((1, 3))), [[0.0, 0.1, 0.0]], atol=1e-15)  # nose down


def test_friction_builds_up_to_its_level_and_takes_work_on_every_cycle():
    gimbal = Gimbal(friction=0.05, give=0.02)
    bearings = Bearings(gimbal, weight=0.0, runs=1, step=1e-3)
    steady = [bearings(LEVEL, np.full((1, 3), 2.0))[0, 0] for _ in range(100)]
    assert abs(steady[0]) < 0.01
    assert steady[-1] == pytest.approx(-0.05, rel=1e-3)
    rates = 3.0 * np.sin(np.linspace(0.0, 4.0 * np.pi, 2000, endpoint=False))
    work = [bearings(LEVEL, np.full((1, 3), rate))[0, 1] * rate * 1e-3 for rate in rates]
    turned = np.abs(rates).sum() * 1e-3
    assert -0.05 * turned < sum(work) < -0.9 * 0.05 * turned


def test_what_is_asked_for_changes_no_faster_than_allowed(racer):
    autopilot = Autopilot(RigCase(runs=1, quickening=50.0), racer)
    targets = []
    for _ in range(5):
        autopilot(np.array([[3.0, -3.0, 0.01]]), np.zeros((1, 3)))
        targets.append(autopilot.target[0].copy())
    np.testing.assert_allclose(targets[-1], [0.25, -0.25, 0.01])


def test_the_autopilot_hovers_and_turns_the_way_it_is_told(racer):
    autopilot = Autopilot(RigCase(runs=1), racer)
    np.testing.assert_allclose(autopilot(np.zeros((1, 3)), np.zeros((1, 3))), racer.hover_rotor_speed)
    speeds = autopilot(np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 3)))
    left = np.array(racer.rotor_positions)[:, 1] > 0.0
    assert speeds[0, left].min() > speeds[0, ~left].max()
