"""Gates take the drift off while a camera sees them, and only then."""

import numpy as np
import pytest

from benchmarks.perception import fixes_along, flown
from simgap.plants.estimator import STEP, Aid, Odometry
from simgap.plants.gates_seen import IMAGE, SHARE, GatesSeen
from tests.pipeline.gates.tracks import track_named
from tests.pipeline.perception.eyes import perception

RUNS = 200
STILL = np.zeros((RUNS, 13))


def at(*distances):
    """See gates at these distances, m, from every machine."""
    return lambda state: np.tile(distances, (len(state), 1))


def wandering(look, images=200, spread=0.05, seed=0):
    """Return the drift that is left of a random walk whose variance grows by so much, m²/s, (images, runs, 3) m."""
    random = np.random.default_rng(seed)
    gates, drift, left = GatesSeen(look, RUNS, random), np.zeros((RUNS, 3)), []
    for _ in range(images):
        drift = drift + np.sqrt(spread * IMAGE) * random.standard_normal(drift.shape)
        drift = gates.corrected(drift, STILL)
        left.append(drift)
    return np.stack(left)


def rms(errors):
    return float(np.sqrt((errors**2).mean()))


def test_without_a_gate_the_drift_stays():
    drift = np.random.default_rng(0).standard_normal((RUNS, 3))
    gates = GatesSeen(at(np.inf, np.inf), RUNS, np.random.default_rng(1))
    np.testing.assert_array_equal(gates.corrected(drift, STILL), drift)
    assert not gates.in_view.any()


@pytest.mark.parametrize("distance", [2.0, 8.0])
def test_with_a_gate_as_much_is_left_as_the_riccati_equation_says(distance):
    grown, noise = 0.05 * IMAGE, (SHARE * distance) ** 2
    before = 0.5 * grown + np.sqrt(0.25 * grown**2 + grown * noise)  # the steady p before an image
    expected = np.sqrt(before * noise / (before + noise))
    assert rms(wandering(at(distance))[100:]) == pytest.approx(expected, rel=0.03)


def test_more_gates_and_nearer_ones_leave_less():
    far, two, near = (rms(wandering(at(*gates))[100:]) for gates in ((8.0,), (8.0, 8.0), (8.0, 2.0)))
    assert near < two < far


def test_each_machine_has_the_gates_that_it_sees():
    sees = np.arange(RUNS) < RUNS // 2
    gates = GatesSeen(lambda _: np.where(sees, 3.0, np.inf)[:, None], RUNS, np.random.default_rng(0))
    left = gates.corrected(np.ones((RUNS, 3)), STILL)
    np.testing.assert_array_equal(gates.in_view, sees)
    assert (left[~sees] == 1.0).all()
    assert (left[sees] < 1.0).any(axis=-1).all()


@pytest.mark.parametrize(("looks", "least", "most"), [((np.inf,), 0.9, 1.5), ((4.0,), 0.0, 0.2)])
def test_odometry_drifts_while_no_gate_is_in_view(looks, least, most):
    odometry = Odometry(1.0, RUNS, 1000, STEP, np.random.default_rng(0), Aid(at(*looks)))
    state = STILL.copy()
    state[:, 3], state[:, 6] = 10.0, 1.0
    for _ in range(1000):
        errors = odometry.advance(state, np.tile([0.0, 0.0, 9.81], (RUNS, 1)))
    assert least < rms(errors.position[:, 0]) < most
    assert rms(errors.velocity[:, 0]) > 0.1


class Omniscient:
    """Cameras that show where machines truly are."""

    in_view = np.ones(RUNS, dtype=bool)
    counts = {"images": np.full(RUNS, 3)}  # noqa: RUF012

    def corrected(self, states, believed):
        return np.concatenate((states[:, :6], believed[:, 6:]), axis=-1)


def test_cameras_correct_position_and_velocity_and_leave_the_rest_to_odometry():
    errors = {}
    for name, aid in (("seen", Aid(sight=Omniscient())), ("alone", Aid(forgets=False))):
        odometry = Odometry(1.0, RUNS, 10, STEP, np.random.default_rng(0), aid)
        state = STILL.copy()
        state[:, 3], state[:, 6] = 10.0, 1.0
        errors[name] = odometry.advance(state, np.tile([0.0, 0.0, 9.81], (RUNS, 1)))
        assert bool(odometry.in_view.all()) == (name == "seen")
        assert set(odometry.counts) == ({"images"} if name == "seen" else set())
    assert rms(errors["seen"].position) == rms(errors["seen"].velocity) == 0.0
    assert rms(errors["alone"].position) > 0.0
    np.testing.assert_array_equal(errors["seen"].attitude, errors["alone"].attitude)
    np.testing.assert_array_equal(errors["seen"].body_rate, errors["alone"].body_rate)


def test_drift_that_is_not_forgotten_adds_up():
    left = {}
    for forgets in (True, False):
        odometry = Odometry(1.0, RUNS, 1000, STEP, np.random.default_rng(0), Aid(forgets=forgets))
        state = STILL.copy()
        state[:, 3], state[:, 6] = 10.0, 1.0
        for _ in range(1000):
            errors = odometry.advance(state, np.tile([0.0, 0.0, 9.81], (RUNS, 1)))
        left[forgets] = rms(errors.position[:, 0])
    assert left[True] < 0.3 < 0.9 < left[False] < 1.5  # 1.2 % of 100 m


def test_a_position_from_a_gate_is_as_good_as_perception_makes_it():
    """Half of the errors are below the median of a normal distribution."""
    track = track_named("split_s")
    fixes = fixes_along(perception(), track, flown(track, laps=1), seed=0, every=10)
    ratios = np.concatenate([np.abs(error) / (SHARE * distance) for distance, error, _ in fixes])
    assert 0.5 < np.median(ratios) / 0.6745 < 1.5
