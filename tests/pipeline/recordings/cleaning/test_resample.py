import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.recordings.cleaning import Cleaning
from simgap.recordings.cleaning.resample import (
    FIFTH_DIFFERENCE,
    noise_kept,
    resample,
    split_at_gaps,
    typical_step,
)

STEP = 0.01


def without(frame, rows):
    return frame.drop(index=rows).reset_index(drop=True)


def resampled(run, step=STEP, **settings):
    split_at_gaps(run, settings.get("max_gap", 0.1))
    return resample(run, step, Cleaning(**settings))


def test_what_is_uniform_is_left_bit_for_bit(flight, as_run):
    run = as_run(flight(), "quadrotor")
    result = resampled(run)
    assert (result.time == run.time).all()
    assert (result.values == run.values).all()
    assert not result.changes


def test_small_jitter_moves_times_but_no_values(joint, as_run):
    frame = joint()
    frame["t"] += 0.03 * STEP * np.random.default_rng(0).uniform(-1, 1, len(frame)) + 1.7e9
    run = as_run(frame, "joint")
    result = resampled(run, jitter=0.05)
    assert (result.values == run.values).all()
    assert np.ptp(np.diff(result.time)) < 1e-6  # a double resolves 0.2 µs there


@pytest.mark.parametrize("samples", [1, 5, 9])
def test_missing_rows_are_put_back_on_a_straight_line(joint, as_run, samples):
    frame = joint()
    frame["position"] = 0.5 * frame["t"]
    rows = list(range(100, 100 + samples))
    run = as_run(without(frame, rows), "joint")
    result = resampled(run)
    assert len(result.time) == len(frame)
    np.testing.assert_allclose(result.channel("position")[:, 0], frame["position"], atol=1e-12)
    assert result.changes[0]["samples"] == samples
    assert (result.stretch == 0).all()


def test_a_wide_gap_splits_and_is_not_filled(joint, as_run):
    run = as_run(without(joint(), range(100, 110)), "joint")
    result = resampled(run)
    assert len(result.time) == len(run.time)
    assert np.flatnonzero(np.diff(result.stretch)).tolist() == [99]
    assert [change["step"] for change in result.changes] == ["gaps"]


def test_inputs_keep_the_earlier_value_and_measurements_are_interpolated(joint, as_run):
    frame = joint()
    frame.loc[100:102, ["voltage", "velocity"]] = np.nan
    frame.loc[99, ["voltage", "velocity"]] = [5.0, 1.0]
    frame.loc[103, ["voltage", "velocity"]] = [9.0, 3.0]
    result = resampled(as_run(frame, "joint"))
    assert result.channel("voltage")[99:104, 0].tolist() == [5.0, 5.0, 5.0, 5.0, 9.0]
    np.testing.assert_allclose(result.channel("velocity")[99:104, 0], [1.0, 1.5, 2.0, 2.5, 3.0])
    assert {change["reason"] for change in result.changes} == {
        "earlier value kept (missing)",
        "interpolated (missing)",
    }


def test_nothing_is_extrapolated(joint, as_run):
    frame = joint()
    frame.loc[:4, "velocity"] = np.nan
    frame.loc[595:, "velocity"] = np.nan
    result = resampled(as_run(frame, "joint"))
    assert np.isnan(result.channel("velocity")[:5]).all()
    assert np.isnan(result.channel("velocity")[595:]).all()


def test_a_slow_channel_is_bridged_farther(joint, as_run):
    frame = joint()
    frame["battery_voltage"] = np.where(np.arange(len(frame)) % 50 == 0, 12 - 0.1 * frame["t"], np.nan)
    result = resampled(as_run(frame, "joint"))
    np.testing.assert_allclose(result.channel("battery_voltage")[:551, 0], 12 - 0.1 * frame["t"][:551])


@given(seed=st.integers(0, 1000))
def test_uneven_times_give_the_values_at_even_ones(
    seed,
):
    from tests.pipeline.recordings.cleaning.conftest import joint_frame, run_of

    frame = joint_frame()
    random = np.random.default_rng(seed)
    frame["t"] = np.cumsum(random.uniform(0.5, 1.5, len(frame))) * STEP
    frame["position"] = 2.0 * frame["t"] - 1.0
    result = resampled(run_of(frame, "joint"))
    np.testing.assert_allclose(np.diff(result.time), STEP, rtol=1e-6)
    np.testing.assert_allclose(result.channel("position")[:, 0], 2.0 * result.time - 1.0, atol=1e-9)
    assert result.time[0] >= frame["t"].iloc[0] - 1e-9
    assert result.time[-1] <= frame["t"].iloc[-1] + 1e-9


def test_an_angle_that_wraps_takes_the_short_way(as_run, frames):
    frame = frames("swerve", runs=1)
    angle = np.pi - 0.05 + 0.01 * np.arange(len(frame))
    frame["steer_angle_1"] = np.remainder(angle + np.pi, 2 * np.pi) - np.pi
    wrap = int(np.argmin(np.diff(frame["steer_angle_1"])))
    frame.loc[wrap, "steer_angle_1"] = np.nan
    result = resampled(as_run(frame, "swerve"))
    assert abs(abs(result.channel("steer_angle_1")[wrap, 0]) - np.pi) < 0.02


@given(st.integers(0, 1000))
def test_the_typical_step_is_right_over_the_whole_run_for_all_jitter_and_losses(seed):
    random = np.random.default_rng(seed)
    time = 0.005 * np.arange(1700) + 2e-4 * np.clip(random.standard_normal(1700), -2.5, 2.5)
    time = np.delete(time, random.choice(np.arange(1, 1699), 10, replace=False))
    time[time > 4.0] += 0.7  # a loss of which nobody knows how long it was
    drift = abs(typical_step(time) - 0.005) * 1700
    assert drift < 2e-4  # no more than the jitter of one sample


def test_the_typical_step_ignores_gaps_and_rounding():
    time = 1.7e9 + np.concatenate([np.arange(500), 900 + np.arange(500)]) * 0.005
    assert typical_step(time) == pytest.approx(0.005, rel=1e-4)
    assert typical_step(np.arange(1000) * 0.01) == 0.01


@given(seed=st.integers(0, 1000))
def test_a_held_command_keeps_its_step_when_the_logger_jitters(seed):
    """Each command is logged a little before or after its tick, and belongs to that tick all the same."""
    from tests.pipeline.recordings.cleaning.conftest import joint_frame, run_of

    frame = joint_frame()
    random = np.random.default_rng(seed)
    frame["voltage"] = random.normal(size=len(frame))
    step = frame["t"].iloc[1] - frame["t"].iloc[0]
    late = random.uniform(-0.2, 0.2, len(frame)) * step
    late[[0, -1]] = 0.0
    jittered = frame.assign(t=frame["t"] + late)
    result = resampled(run_of(jittered, "joint"))
    assert len(result.time) == len(frame)
    np.testing.assert_allclose(result.channel("voltage")[:, 0], frame["voltage"], rtol=1e-12, atol=1e-14)


@given(seed=st.integers(0, 1000))
def test_the_impulse_of_held_commands_is_kept_where_the_controller_follows_no_clock(seed):
    """Steps of the controller scatter and add up: its commands begin anywhere between two samples of the grid."""
    from tests.pipeline.recordings.cleaning.conftest import joint_frame, run_of

    frame = joint_frame()
    random = np.random.default_rng(seed)
    frame["voltage"] = random.normal(size=len(frame))
    steps = frame["t"].diff().fillna(0.0) * random.uniform(0.8, 1.2, len(frame))
    jittered = frame.assign(t=frame["t"].iloc[0] + np.cumsum(steps))
    result = resampled(run_of(jittered, "joint"))
    held = np.cumsum(jittered["voltage"].to_numpy()[:-1] * np.diff(jittered["t"]))
    impulse = np.concatenate([[0.0], result.time_step * np.cumsum(result.channel("voltage")[:, 0])])[:-1]
    np.testing.assert_allclose(
        impulse, np.interp(result.time, jittered["t"], [0.0, *held]), rtol=0, atol=1e-12
    )


def test_samples_whose_input_was_made_up_are_marked_and_stay_so(joint, as_run):
    frame = joint()
    once = resampled(as_run(without(frame, [50, 51]), "joint"))
    assert np.flatnonzero(once.filled).tolist() == [50, 51]
    assert np.flatnonzero(resampled(once).filled).tolist() == [50, 51]


@pytest.mark.parametrize("jitter", [0.0, 0.15, 0.3, 0.45])
def test_interpolation_keeps_as_much_of_white_noise_as_it_says(jitter):
    random = np.random.default_rng(0)
    grid = STEP * np.arange(20000)
    recorded = grid + jitter * STEP * random.uniform(-1.0, 1.0, len(grid))
    noise = np.interp(grid, recorded, random.standard_normal(len(grid)))
    squared = np.convolve(noise[1:-1], FIFTH_DIFFERENCE, "valid") ** 2 / np.square(FIFTH_DIFFERENCE).sum()
    shown = np.median(squared) / 0.455
    assert noise_kept(recorded, grid) == pytest.approx(shown, rel=0.1)


def test_halfway_between_samples_a_twelfth_of_the_noise_is_shown(joint, as_run):
    """The noise halves, and of what is left a fifth difference shows a sixth: Σ(c_j + c_{j+1})²/4 of 252."""
    frame = joint()
    run = as_run(frame, "joint")
    time = np.asarray(frame["t"], dtype=float)
    assert noise_kept(time, time[:-1] + 0.5 * STEP) == pytest.approx(1.0 / 12.0, rel=0.01)
    assert resampled(run).noise_kept == 1.0


def test_on_a_grid_much_finer_than_the_recording_a_noise_is_still_something():
    recorded = STEP * np.arange(100)
    assert noise_kept(recorded, 0.1 * STEP * np.arange(990)) == pytest.approx(1.0 / 12.0)
