"""What looks wrong is used, and said."""

import numpy as np
import pytest

from simgap.recordings import read_recording
from simgap.recordings.contract import KINDS


@pytest.fixture
def doubted(frames, tmp_path):
    """Return a function that changes a good frame and returns what its reading warns of."""

    def warnings(change=lambda frame: frame, kind="joint", **shape):
        path = tmp_path / "a.parquet"
        change(frames(kind, **shape)).to_parquet(path)
        return " ".join(read_recording(path).warnings)

    return warnings


@pytest.mark.parametrize("kind", KINDS)
def test_a_good_recording_raises_none(doubted, kind):
    assert doubted(kind=kind) == ""


def test_one_run_only(doubted):
    assert "none can be held out" in doubted(runs=1)


def test_the_sign_of_a_quaternion_does_not_matter(doubted):
    def flip(frame):
        axes = [f"attitude_{axis}" for axis in "wxyz"]
        frame.loc[::3, axes] *= -1
        return frame

    assert doubted(flip, "quadrotor") == ""


def test_a_wheel_that_turns_on_raises_no_doubt(doubted):
    def change(frame):
        return frame.assign(position=100 * frame["t"] + frame["position"], velocity=100 + frame["velocity"])

    assert doubted(change) == ""


def test_huge_gap_in_time(doubted):
    said = doubted(
        lambda frame: frame.drop(index=range(50, 60)).assign(
            t=lambda kept: kept["t"] + 30 * (kept["t"] > 0.5)
        )
    )
    assert "Run 'run0' has 1 gap(s) in time; the longest is 30.1 s after t = 0.49 s (row 50)." in said


def test_time_in_milliseconds(doubted):
    assert "milliseconds instead of seconds?" in doubted(lambda frame: frame.assign(t=1e4 * frame["t"]))


def test_unknown_column_is_ignored_with_the_nearest_name(doubted):
    said = doubted(lambda frame: frame.assign(temprature=20.0))
    assert said == "Column 'temprature' is unknown for a joint (did you mean 'temperature'?) and was ignored."


def test_constant_channel(doubted):
    assert (
        doubted(lambda frame: frame.assign(voltage=6.0))
        == "Channel 'voltage' is constant (6) in the whole recording."
    )


def test_optional_channels_without_values_or_incomplete(doubted, frames):
    assert "'temperature' has no values" in doubted(lambda frame: frame.assign(temperature=np.nan))
    said = doubted(lambda frame: frame.assign(specific_force_z=9.81 + frame["velocity_z"]), "quadrotor")
    assert (
        said
        == "Column 'specific_force_x' is missing, so the other components of specific_force were ignored."
    )


def test_a_run_without_values_of_a_required_channel(doubted):
    def change(frame):
        frame.loc[frame["run"] == "run1", "velocity"] = np.nan
        return frame

    assert "Run 'run1' has no values in velocity." in doubted(change, runs=3)

    def change_two(frame):
        return frame.assign(velocity=frame["velocity"].where(frame["run"] == "run0"))

    assert "2 runs, from 'run1' on, have no values in velocity." in doubted(change_two, runs=3)
