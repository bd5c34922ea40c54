"""A velocity that is a late average of the position's rate gives way to that rate; one that is filtered stays."""

import numpy as np
import pandas as pd
import pytest

from simgap.recordings.cleaning import clean_recording
from simgap.recordings.cleaning.filtered import replace_averaged
from simgap.recordings.recording import recording_from_frame
from tests.pipeline.recordings.cleaning.conftest import run_of

STEP = 0.005
ROUGHNESS = 1e-5  # rad, noise of the position


def motion(time: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a position and its exact velocity: a sum of sines."""
    random = np.random.default_rng(seed)
    rates, phases = random.uniform(0.3, 1.5, 5) * 2 * np.pi, random.uniform(0, 2 * np.pi, 5)
    waves = rates * time[:, None] + phases
    return np.sin(waves).sum(axis=1), (rates * np.cos(waves)).sum(axis=1)


def averaged(time: np.ndarray, seconds: float, seed: int) -> np.ndarray:
    """Return the mean velocity over the last so many seconds."""
    return (motion(time, seed)[0] - motion(time - seconds, seed)[0]) / seconds


def uneven(seed: int, count: int = 1200, longest: float = 4.0) -> np.ndarray:
    """Return times whose steps differ by as much as those of a program that is not alone on its computer."""
    steps = STEP * np.random.default_rng(seed).choice(
        [0.8, 1.0, 1.0, 1.2, longest], count, p=[0.3, 0.3, 0.1, 0.28, 0.02]
    )
    return np.cumsum(steps)


def cleaned(time: np.ndarray, velocity: np.ndarray, seed: int):
    position = motion(time, seed)[0] + np.random.default_rng(seed).normal(0, ROUGHNESS, len(time))
    run = run_of(pd.DataFrame({"run": "one", "t": time, "position": position, "velocity": velocity}), "joint")
    replace_averaged(run)
    return run


@pytest.mark.parametrize("seconds", [0.04, 0.15, 0.28, 0.4])
@pytest.mark.parametrize("time", [STEP * np.arange(1200), uneven(1)], ids=["even", "uneven"])
def test_a_moving_average_gives_way_to_the_rate_of_the_position(time, seconds):
    run = cleaned(time, averaged(time, seconds, 3), 3)
    velocity, inside = motion(time, 3)[1], slice(30, -30)
    assert np.abs((run.column("velocity") - velocity)[inside]).max() < 0.05 * np.abs(velocity).max()
    (said,) = run.remarks
    over = float(said.partition("average over ")[2].partition(" s")[0])
    assert over == pytest.approx(seconds, rel=0.05, abs=1.01 * STEP)


@pytest.mark.parametrize("lag", [0.008, 0.02, 0.04, 0.15])
def test_a_first_order_filter_is_left_for_the_search(lag):
    time = STEP * np.arange(1200)
    velocity, kept = motion(time, 4)[1], np.exp(-STEP / lag)
    filtered = np.zeros_like(velocity)
    for row in range(1, len(velocity)):
        filtered[row] = kept * filtered[row - 1] + (1 - kept) * velocity[row]
    run = cleaned(time, filtered, 4)
    np.testing.assert_array_equal(run.column("velocity"), filtered)
    assert not run.remarks


@pytest.mark.parametrize("seed", range(4))
def test_a_right_velocity_stays_beside_a_position_whose_times_are_off(seed):
    """A step: at a constant speed the rate is so noisy that even a late average of it comes nearer to the velocity."""
    random = np.random.default_rng(seed)
    time = STEP * np.arange(600)
    stamps = time + random.uniform(-0.3, 0.3, len(time)) * STEP
    velocity = 2.5 * (1.0 - np.exp(-time / 0.15))
    frame = {"run": "one", "t": stamps, "position": 2.5 * time - 0.15 * velocity, "velocity": velocity}
    run = run_of(pd.DataFrame(frame), "joint")
    replace_averaged(run)
    np.testing.assert_array_equal(run.column("velocity"), velocity)


@pytest.mark.parametrize("samples", [200, 241, 600])
def test_a_run_may_be_hardly_longer_than_the_average(samples):
    time = STEP * np.arange(samples)
    for seconds in (0.28, 0.31):
        run = cleaned(time, averaged(time, seconds, 3), 3)
        assert np.isfinite(run.column("velocity")).all()


def test_over_a_long_gap_no_rate_is_made_up():
    time = uneven(2, longest=12.0)
    run = cleaned(time, averaged(time, 0.15, 5), 5)
    np.testing.assert_array_equal(run.column("velocity"), averaged(time, 0.15, 5))
    assert not run.remarks


def test_what_is_said_of_several_runs_is_said_once():
    time = STEP * np.arange(1200)
    position, velocity = motion(time, 6)
    velocities = {"a": averaged(time, 0.15, 6), "b": velocity, "c": averaged(time, 0.15, 6)}
    frames = [
        pd.DataFrame({"run": run, "t": time, "position": position, "velocity": each, "effort": np.sin(time)})
        for run, each in velocities.items()
    ]
    warnings = clean_recording(recording_from_frame(pd.concat(frames, ignore_index=True), "joint"))[
        0
    ].warnings
    (said,) = [warning for warning in warnings if "moving average" in warning]
    assert said.endswith("took its place in 2 of 3 runs.")
