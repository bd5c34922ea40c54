import dataclasses

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.recordings import Recording, read_recording, write_recording
from simgap.recordings.cleaning import (
    CHANGE_COLUMNS,
    Cleaning,
    clean_recording,
    clean_with_coverage,
    summary,
)
from simgap.recordings.contract import needed_channels
from simgap.recordings.split import Split
from tests.pipeline.recordings.cleaning.conftest import flight_frame, joint_frame, recording_of

FRAMES = {"quadrotor": flight_frame, "joint": joint_frame}


def spoiled(kind: str, seed: int) -> Recording:
    """Return three runs with everything wrong that a log can have."""
    random = np.random.default_rng(seed)
    parts = []
    for number in range(3):
        frame = FRAMES[kind](seconds=6.0, seed=seed + number, run=f"run {number}")
        channels = [column for column in frame if column not in ("run", "t")]
        frame.loc[random.choice(600, 60), random.choice(channels)] = np.nan
        frame.loc[random.integers(20, 580), random.choice(channels)] *= 50.0
        start = random.integers(10, 400)
        frame.loc[start : start + random.integers(1, 150), channels] = np.nan
        held = random.integers(50, 500)
        frame.loc[held : held + 3, channels] = frame.loc[held - 1, channels].to_numpy()
        frame = frame.drop(index=random.choice(600, random.integers(0, 200), replace=False))
        if random.random() < 0.3:
            frame["t"] += 0.002 * random.random(len(frame))
        if random.random() < 0.5:
            frame.loc[frame["t"] > 4.0, "t"] += 1.0
        parts.append(frame)
    frame = pd.concat(parts, ignore_index=True)
    quaternion = [column for column in frame if column.startswith("attitude")]
    if quaternion:  # reading would refuse what is no rotation
        norm = np.linalg.norm(frame[quaternion].to_numpy(), axis=1)
        frame.loc[np.abs(norm - 1) > 0.1, quaternion] = np.nan
    return recording_of(frame, kind)


@pytest.mark.parametrize("kind", FRAMES)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=5, deadline=None)
def test_the_account_balances_and_the_promises_hold(kind, seed):
    recording = spoiled(kind, seed)
    cleaned = clean_with_coverage(recording)
    result, changes = cleaned.recording, cleaned.changes
    assert tuple(changes.columns) == CHANGE_COLUMNS
    moved = changes[changes["column"] == ""].groupby("run")["samples"].sum()
    recorded = recording.frame.groupby("run").size()
    kept = result.frame.groupby("run").size()
    assert (recorded.add(moved, fill_value=0) == kept.reindex(recorded.index, fill_value=0)).all()
    table = summary(recording, cleaned)
    assert (table["recorded"] + table["resampled"] - table["dropped"] == table["kept"]).all()
    needed = needed_channels(kind, set(result.channels))
    assert np.isfinite(result.frame[needed].to_numpy()).all()
    for _, stretch in result.frame.groupby(["run", "segment"]):
        np.testing.assert_allclose(np.diff(stretch["t"]), result.time_step, rtol=1e-6)
        assert len(stretch) >= 10
    for run, rows in cleaned.coverage.groupby("run"):
        assert (rows["start"].to_numpy()[1:] >= rows["end"].to_numpy()[:-1] - 1e-9).all()
        used = rows[rows["state"].isin(["kept", "interpolated"])]
        assert (used["end"] - used["start"]).sum() == pytest.approx(kept.get(run, 0) * result.time_step)


@pytest.mark.parametrize("kind", FRAMES)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=5, deadline=None)
def test_values_that_are_kept_were_recorded(kind, seed):
    """Every value of a run that was on time is as recorded, or its channel's change says how many are not."""
    recording = spoiled(kind, seed)
    result, changes = clean_recording(recording)
    moved = set(changes[changes["reason"].str.startswith("resampled")]["run"])
    for run, rows in result.frame.groupby("run"):
        if run in moved:
            continue
        raw = recording.frame[recording.frame["run"] == run]
        grid = lambda time: np.round(time / 0.01).astype(int)  # noqa: E731
        before = raw.set_index(grid(raw["t"]))
        after = rows.set_index(grid(rows["t"]))
        for column in (column for column in result.channels if not column.startswith("attitude")):
            recorded = before[column].reindex(after.index)
            changed = (after[column] != recorded) & ~(after[column].isna() & recorded.isna())
            told = changes[(changes["run"] == run) & (changes["column"] == column)]
            assert changed.sum() <= told["samples"].sum()


@pytest.mark.parametrize("kind", FRAMES)
def test_cleaning_a_clean_recording_changes_nothing(kind):
    once, _ = clean_recording(spoiled(kind, 1))
    again, changes = clean_recording(once)
    assert changes.empty
    pd.testing.assert_frame_equal(again.frame, once.frame)
    # nor where the mark of being clean was lost
    third, changes = clean_recording(dataclasses.replace(once, cleaned=False))
    assert changes[changes["step"] != "clock"].empty
    pd.testing.assert_frame_equal(third.frame, once.frame)


def test_a_good_recording_is_left_as_it_is():
    frame = pd.concat(
        [flight_frame(run=name, seed=seed) for seed, name in enumerate("abc")], ignore_index=True
    )
    recording = recording_of(frame, "quadrotor")
    result, changes = clean_recording(recording, split=Split(holdout=["c"]))
    pd.testing.assert_frame_equal(result.frame.drop(columns="segment"), frame)
    assert set(changes["step"]) == {"clock"}
    assert result.split == {"a": "train", "b": "train", "c": "holdout"}
    assert set(result.clock_offset) == {"a", "b", "c"}


def test_a_clean_recording_survives_the_file(tmp_path):
    result, _ = clean_recording(spoiled("quadrotor", 2))
    write_recording(result, tmp_path / "clean.parquet")
    back = read_recording(tmp_path / "clean.parquet")
    pd.testing.assert_frame_equal(back.frame, result.frame)
    assert (back.cleaned, back.split, back.clock_offset) == (True, result.split, result.clock_offset)


def test_the_same_recording_is_cleaned_the_same_way():
    first, second = (clean_with_coverage(spoiled("quadrotor", 4)) for _ in range(2))
    pd.testing.assert_frame_equal(first.recording.frame, second.recording.frame)
    pd.testing.assert_frame_equal(first.changes, second.changes)
    pd.testing.assert_frame_equal(first.coverage, second.coverage)


def test_a_run_that_lacks_a_channel_is_dropped_with_the_reason():
    frame = pd.concat([joint_frame(run="a"), joint_frame(run="b")], ignore_index=True)
    frame.loc[frame["run"] == "b", "velocity"] = np.nan
    result, changes = clean_recording(recording_of(frame, "joint"))
    assert result.runs == ["a"]
    (row,) = changes[changes["run"] == "b"].to_dict("records")
    assert (row["step"], row["reason"], row["samples"]) == ("missing", "no values in velocity", -600)


def test_a_group_recorded_for_a_small_part_does_not_cut_off_the_rest():
    frame = flight_frame()
    for rotor in "1234":
        frame[f"motor_command_{rotor}"] = np.where(frame["t"] < 1.0, 0.5, np.nan)
    result, changes = clean_recording(recording_of(frame, "quadrotor"))
    assert len(result.frame) == len(frame)
    assert result.frame["motor_command_1"].isna().all()
    assert set(changes[changes["step"] == "missing"]["samples"]) == {100}


def test_where_nothing_is_left_the_reasons_are_said():
    frame = joint_frame()
    frame["voltage"] = frame["velocity"] = 0.0
    with pytest.raises(InputError, match=r"nothing usable is left .*no input on any motor.* \(600 samples\)"):
        clean_recording(recording_of(frame, "joint"))


@pytest.mark.parametrize(
    ("key", "value"), [("time_step", -0.01), ("max_gap", -1.0), ("jitter", 0.7), ("max_clock_offset", 0.0)]
)
def test_limits_that_make_no_sense_are_refused(key, value):
    with pytest.raises(InputError, match=rf"clean\.{key}"):
        clean_recording(recording_of(joint_frame(), "joint"), Cleaning(**{key: value}))


def test_a_time_step_that_is_asked_for_is_kept():
    result, changes = clean_recording(recording_of(joint_frame(), "joint"), Cleaning(time_step=0.02))
    assert result.time_step == pytest.approx(0.02)
    assert len(result.frame) == 300
    assert changes["reason"].str.startswith("resampled").any()


def test_runs_of_one_sample_are_dropped():
    frame = pd.concat([joint_frame(), joint_frame(run="tiny")[:1]], ignore_index=True)
    result, changes = clean_recording(recording_of(frame, "joint"))
    assert result.runs == ["one"]
    assert (changes["run"] == "tiny").sum() == 1
