import numpy as np
import pytest

from simgap.plants.integration import AdamsBashforth
from simgap.plants.rotation import cross, matrix, product
from simgap.plants.spin import Spin

DIRECTIONS = np.array([-1.0, 1.0, -1.0, 1.0])
INERTIA = np.array([2.9e-3, 2.4e-3, 5.0e-3])


def test_body_and_rotors_keep_their_angular_momentum_in_free_space():
    rotor, step = 4e-5, 5e-4
    spin, advance = Spin(DIRECTIONS, rotor, rotor), AdamsBashforth(step)
    state = np.array([[1.0, 0.0, 0.0, 0.0, 2.0, -1.0, 0.5]])
    momenta = []
    for index in range(4000):
        time = index * step
        wave = np.array([1.0, 1.7, 2.3, 3.1])
        speed = 1000.0 + 300.0 * np.sin(wave * 3.0 * time)[None]
        acceleration = 900.0 * wave * np.cos(wave * 3.0 * time)[None]
        rate = state[:, 4:]
        angular = INERTIA * rate - rotor * (speed @ DIRECTIONS)[:, None] * [0.0, 0.0, 1.0]
        momenta.append((matrix(state[:, :4]) @ angular[..., None])[0, :, 0])
        torque = spin.torque(speed, acceleration, rate) - cross(rate, INERTIA * rate)
        quaternion = 0.5 * product(state[:, :4], np.concatenate((np.zeros((1, 1)), rate), axis=-1))
        state = advance(state, np.concatenate((quaternion, torque / INERTIA), axis=-1))
        state[:, :4] /= np.linalg.norm(state[:, :4])
    assert np.abs(state[0, 4:] - [2.0, -1.0, 0.5]).max() > 0.3  # the rotors did move the body
    np.testing.assert_allclose(momenta, np.broadcast_to(momenta[0], (4000, 3)), atol=2e-5)


def test_a_rotor_that_speeds_up_twists_the_body_the_way_its_drag_does():
    spin = Spin(DIRECTIONS, 1e-5, 0.0)
    torque = spin.torque(np.full(4, 1000.0), np.array([0.0, 200.0, 0.0, 0.0]), np.array([3.0, 2.0, 1.0]))
    np.testing.assert_allclose(torque, [0.0, 0.0, 1e-5 * 200.0])


def test_pairs_that_spin_alike_do_not_mind_being_turned():
    spin = Spin(DIRECTIONS, 0.0, 1e-5)
    turned = np.array([3.0, 2.0, 1.0])
    np.testing.assert_array_equal(spin.torque(np.full(4, 1000.0), np.ones(4), turned), 0.0)
    uneven = spin.torque(np.array([900.0, 1100.0, 900.0, 1100.0]), np.ones(4), turned)
    assert uneven @ turned == pytest.approx(0.0, abs=1e-12)  # it does no work
    np.testing.assert_allclose(uneven, 1e-5 * 400.0 * np.array([2.0, -3.0, 0.0]))
