import numpy as np
import pytest

from simgap.plants.payload import Payload

GRAVITY, STEP = 9.81, 1e-3


def swung(vehicle_mass, mass, length, angle, force, seconds):
    """Return the cable's angle to the vertical and its rate (steps,), under a constant force on the machine."""
    payload = Payload(vehicle_mass, mass, length, 1, STEP)
    payload.drag = 0.0
    payload.direction = np.array([[np.sin(angle), 0.0, -np.cos(angle)]])
    still, angles, rates = np.zeros((1, 3)), [], []
    for _ in range(round(seconds / STEP)):
        angles.append(np.arctan2(payload.direction[0, 0], -payload.direction[0, 2]))
        rates.append(np.hypot(payload.swing[0, 0], payload.swing[0, 2]) * np.sign(payload.swing[0, 0]))
        payload.pull(np.array([[0.0, 0.0, force]]), still)
    return np.array(angles), np.array(rates)


def period(angles):
    falling = np.flatnonzero((angles[:-1] > 0) & (angles[1:] <= 0))
    return np.diff(falling).mean() * STEP


@pytest.mark.parametrize("length", [0.3, 1.2])
def test_under_a_machine_that_holds_still_it_is_a_pendulum(length):
    angles, _ = swung(1e9, 0.2, length, 0.02, 1e9 * GRAVITY, 12.0)
    assert period(angles) == pytest.approx(2 * np.pi * np.sqrt(length / GRAVITY), rel=1e-3)


def test_under_a_machine_that_hovers_freely_it_swings_faster():
    mass, load, length = 0.9, 0.3, 0.8
    angles, _ = swung(mass, load, length, 0.02, (mass + load) * GRAVITY, 12.0)
    frequency = np.sqrt((mass + load) / mass * GRAVITY / length)
    assert period(angles) == pytest.approx(2 * np.pi / frequency, rel=1e-3)


def test_a_wide_swing_keeps_its_energy():
    mass, load, length = 0.9, 0.3, 0.8
    force = (mass + load) * GRAVITY
    angles, rates = swung(mass, load, length, 1.2, force, 20.0)
    energy = 0.5 * length * rates**2 + force / mass * (1.0 - np.cos(angles))
    np.testing.assert_allclose(energy, energy[0], rtol=5e-4)


def test_machine_and_load_move_as_one_about_their_common_centre():
    """Of all forces only thrust and weight act from outside: the centre of mass accelerates by them alone."""
    mass, load, length = 0.9, 0.3, 0.8
    payload = Payload(mass, load, length, 1, STEP)
    payload.drag = 0.0
    random = np.random.default_rng(0)
    payload.swing = np.array([[1.5, -0.7, 0.0]])
    velocity, place, outside = np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3))
    start = load * length * payload.swing
    for _ in range(2000):
        force = random.normal(0.0, 3.0, (1, 3))
        velocity = velocity + STEP * (force + payload.pull(force, velocity)) / mass
        outside += STEP * force
        place += STEP * velocity
    momentum = (mass + load) * velocity + load * length * payload.swing
    np.testing.assert_allclose(momentum, start + outside, atol=2e-3)


def test_it_pulls_with_its_weight_where_nothing_moves():
    payload = Payload(0.9, 0.3, 0.8, 2, STEP)
    pull = payload.pull(np.tile([0.0, 0.0, 1.2 * GRAVITY], (2, 1)), np.zeros((2, 3)))
    np.testing.assert_allclose(pull, [[0.0, 0.0, -0.3 * GRAVITY]] * 2, atol=1e-12)


def test_air_holds_the_load_back():
    payload = Payload(0.9, 0.3, 0.8, 1, STEP)
    for _ in range(3000):
        payload.pull(np.array([[0.0, 0.0, 1.2 * GRAVITY]]), np.array([[8.0, 0.0, 0.0]]))
    assert payload.direction[0, 0] < 0
