from dataclasses import replace

import numpy as np
import pytest

from benchmarks.perception import corrected, error_of, flown, noisy_corners, odometry_of
from simgap.perception.correction import DriftCorrection
from tests.pipeline.gates.tracks import track_named
from tests.pipeline.perception.eyes import perception, standing_before


@pytest.mark.slow
def test_three_laps_with_the_gates_are_five_times_better_than_odometry_alone():
    """Ten images a second: fewer than a camera takes."""
    settings, track = perception(), track_named("split_s")
    flight = flown(track)
    odometry = odometry_of(flight, 0.3, np.random.default_rng(0))
    alone = error_of(flight, odometry)
    seen = noisy_corners(settings, track, flight, seed=0, every=10)
    with_gates = error_of(flight, corrected(settings, track, flight, odometry, 0, seen))
    assert alone > 5.0 * with_gates


def test_gates_that_are_not_there_are_found_out():
    """Odometry hardly drifts here, so that what is wrong came from gates."""
    settings, track = perception(), track_named("split_s")
    flight = flown(track, laps=1)
    odometry = odometry_of(flight, 0.02, np.random.default_rng(0))

    def left(taken: float, false: float) -> float:
        chosen = replace(settings, drift=replace(settings.drift, taken=taken))
        seen = noisy_corners(chosen, track, flight, 0, 10, false)
        return error_of(flight, corrected(chosen, track, flight, odometry, 0, seen))

    checked = left(settings.drift.taken, false=2.0)
    assert checked < 1.5 * left(settings.drift.taken, false=0.0)
    assert checked < 0.1 * left(1.0, false=2.0)


def test_without_an_image_the_odometry_stands():
    correction = DriftCorrection(perception(), track_named("tiny"), seed=0)
    machine = standing_before(track_named("tiny"), 0, 4.0)
    correction.advance(0.01)
    assert correction.see(np.zeros((0, 4, 2)), machine) == []
    position, velocity = correction.corrected(machine.position, np.ones(3))
    assert position == pytest.approx(machine.position)
    assert velocity == pytest.approx(np.ones(3))
