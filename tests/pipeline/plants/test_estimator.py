"""Odometry errs as it is flown."""

import numpy as np
import pytest

from simgap.plants.estimator import STEP, Odometry, believed_state

RUNS, STEPS = 40, 400
HOVER = np.array([0.0, 0.0, 9.81])


def states(speed=0.0):
    state = np.zeros((RUNS, 13))
    state[:, 3], state[:, 6] = speed, 1.0
    return state


def flown(speed=0.0, force=HOVER, scale=1.0, seed=0):
    odometry = Odometry(scale, RUNS, STEPS, STEP, np.random.default_rng(seed))
    state = states(speed)
    return [odometry.advance(state, np.tile(force, (RUNS, 1))) for _ in range(STEPS)]


def test_speed_is_misjudged_by_a_share_of_it_and_adds_up_in_position():
    slow, fast = (np.mean([e.velocity[:, 0] for e in flown(speed)]) for speed in (0.0, 10.0))
    assert abs(slow) < 0.03
    assert fast - slow == pytest.approx(-0.12, abs=0.03)
    last = flown(10.0)[-1].position[:, 0].mean()
    assert last == pytest.approx(-0.12 * 2.0 * (1.0 - np.exp(-STEPS * STEP / 2.0)), abs=0.06)


def test_acceleration_to_the_left_is_taken_for_a_tilt():
    tilt = np.mean([e.attitude for e in flown(force=np.array([0.0, 9.81, 9.81]))], axis=(0, 1))
    assert tilt[0] == pytest.approx(0.025 * np.sqrt(0.5), abs=0.003)
    assert np.abs(tilt[1:]).max() < 0.004


def test_errors_are_those_of_their_seed_and_scale():
    once, again, double, other = flown()[-1], flown()[-1], flown(scale=2.0)[-1], flown(seed=1)[-1]
    np.testing.assert_array_equal(once.position, again.position)
    np.testing.assert_allclose(double.velocity, 2.0 * once.velocity)
    assert not np.allclose(once.velocity, other.velocity)


def test_a_machine_without_errors_believes_the_truth():
    state = states(3.0)
    np.testing.assert_allclose(believed_state(state, flown(3.0, scale=0.0)[-1]), state)
