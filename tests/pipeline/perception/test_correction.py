import numpy as np
import pytest

from benchmarks.perception import corrected, error_of, flown, odometry_of
from simgap.perception.correction import DriftCorrection
from tests.pipeline.gates.tracks import track_named
from tests.pipeline.perception.eyes import perception, standing_before


def test_three_laps_with_the_gates_are_five_times_better_than_odometry_alone():
    """Ten images a second: fewer than a camera takes."""
    settings, track = perception(), track_named("split_s")
    flight = flown(track)
    odometry = odometry_of(flight, 0.3, np.random.default_rng(0))
    alone = error_of(flight, odometry)
    with_gates = error_of(flight, corrected(settings, track, flight, odometry, seed=0, every=10))
    assert alone > 5.0 * with_gates


def test_without_an_image_the_odometry_stands():
    correction = DriftCorrection(perception(), track_named("tiny"), seed=0)
    machine = standing_before(track_named("tiny"), 0, 4.0)
    correction.advance(0.01)
    assert correction.see(np.zeros((0, 4, 2)), machine) == []
    position, velocity = correction.corrected(machine.position, np.ones(3))
    assert position == pytest.approx(machine.position)
    assert velocity == pytest.approx(np.ones(3))
