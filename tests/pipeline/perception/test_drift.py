from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.stats import chi2

from simgap.perception.drift import DriftFilter
from simgap.perception.settings import DriftSettings

PERIOD, EVERY, STEPS, RUNS = 0.01, 4, 60, 100
SETTINGS = DriftSettings()
NOISE = np.diag([0.2, 0.1, 0.4]) ** 2  # m², of a measurement
FORWARD = np.block([[np.eye(3), PERIOD * np.eye(3)], [np.zeros((3, 3)), np.eye(3)]])
SPREAD = np.sqrt([SETTINGS.position] * 3 + [SETTINGS.velocity] * 3)


def unsure(steps: int, **changed) -> DriftFilter:
    """Return a filter some steps after it began."""
    drift = DriftFilter(replace(SETTINGS, **changed))
    for _ in range(steps):
        drift.advance(PERIOD)
    return drift


def test_it_begins_without_drift_and_sure_of_it():
    drift = DriftFilter(SETTINGS)
    assert not drift.position.any()
    assert not drift.velocity.any()
    assert not drift.covariance.any()


def test_uncertainty_grows_by_the_published_matrices():
    drift = DriftFilter(SETTINGS)
    noise = np.diag(SPREAD**2)
    drift.advance(PERIOD)
    np.testing.assert_allclose(drift.covariance, noise)
    drift.advance(PERIOD)
    np.testing.assert_allclose(drift.covariance, FORWARD @ noise @ FORWARD.T + noise)


def test_gates_of_one_image_come_to_the_same_as_one_update_of_all():
    random = np.random.default_rng(0)
    drifts = random.standard_normal((3, 3))
    covariances = np.stack([part @ part.T + 0.1 * np.eye(3) for part in random.standard_normal((3, 3, 3))])
    drift = unsure(2, taken=1.0)
    seen, before = np.tile(np.eye(3, 6), (3, 1)), drift.covariance
    gain = before @ seen.T @ np.linalg.inv(seen @ before @ seen.T + block_diag(*covariances))
    assert sorted(drift.correct(drifts, covariances)) == [0, 1, 2]
    np.testing.assert_allclose(np.concatenate((drift.position, drift.velocity)), gain @ drifts.ravel())
    np.testing.assert_allclose(drift.covariance, (np.eye(6) - gain @ seen) @ before, atol=1e-12)


def test_a_steady_drift_is_found_with_its_velocity():
    drift, speed = DriftFilter(SETTINGS), np.array([0.3, -0.2, 0.1])
    for step in range(1, 400):
        drift.advance(PERIOD)
        drift.correct(step * PERIOD * speed[None], 1e-8 * np.eye(3)[None])
    np.testing.assert_allclose(drift.position, 399 * PERIOD * speed, atol=1e-4)
    np.testing.assert_allclose(drift.velocity, speed, atol=0.02)


@pytest.mark.parametrize("taken", [0.5, 0.9])
def test_right_measurements_are_believed_as_often_as_is_asked_for(taken):
    count = 1000
    spread = unsure(EVERY).covariance[:3, :3] + NOISE
    right = np.random.default_rng(5).multivariate_normal(np.zeros(3), spread, count)
    believed = sum(len(unsure(EVERY, taken=taken).correct(one[None], NOISE[None])) for one in right)
    assert believed / count == pytest.approx(taken, abs=4.0 * np.sqrt(taken * (1.0 - taken) / count))


def test_what_is_far_changes_nothing_until_the_filter_has_become_unsure():
    far, sure, later = np.array([[4.0, 0.0, 0.0]]), unsure(EVERY), unsure(100)
    before = sure.covariance
    assert sure.correct(far, NOISE[None]) == []
    np.testing.assert_array_equal(sure.covariance, before)
    assert not sure.position.any()
    assert later.correct(far, NOISE[None]) == [0]


def test_what_would_pass_alone_is_refused_beside_gates_that_agree():
    wrong, right = [1.5, 0.0, 0.0], [0.1, 0.0, 0.0]
    assert unsure(EVERY).correct(np.array([wrong]), NOISE[None]) == [0]
    taken = unsure(EVERY).correct(np.array([right, wrong, right]), np.stack([NOISE] * 3))
    assert sorted(taken) == [0, 2]


def mean_nees(settings: DriftSettings) -> float:
    """Return the normalised squared error of the estimated drift at the end of runs, on average.

    The drifts of the runs grow by the published matrices. The filter may believe in others.
    """
    random, total = np.random.default_rng(3), 0.0
    for _ in range(RUNS):
        drift, truth = DriftFilter(settings), np.zeros(6)
        for step in range(1, STEPS + 1):
            truth = FORWARD @ truth + SPREAD * random.standard_normal(6)
            drift.advance(PERIOD)
            if step % EVERY == 0:
                drift.correct((truth[:3] + random.multivariate_normal(np.zeros(3), NOISE))[None], NOISE[None])
        error = truth - np.concatenate((drift.position, drift.velocity))
        total += error @ np.linalg.solve(drift.covariance, error)
    return total / RUNS


def test_the_filter_is_as_wrong_as_it_says():
    """A right filter leaves the band of 95 % with one seed in twenty, one that believes in half the noise with all."""
    low, high = chi2.ppf([0.025, 0.975], 6 * RUNS) / RUNS
    assert low < mean_nees(SETTINGS) < high
    assert mean_nees(DriftSettings(0.5 * SETTINGS.position, 0.5 * SETTINGS.velocity)) > high
