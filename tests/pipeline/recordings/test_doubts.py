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


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_body_rate_in_degrees(doubted, noise):
    def change(frame):
        rates = [f"body_rate_{axis}" for axis in "xyz"]
        frame[rates] = np.degrees(
            frame[rates] + noise * np.random.default_rng(0).normal(size=frame[rates].shape)
        )
        return frame

    said = doubted(change, "quadrotor")
    assert "'body_rate_x' is 5" in said
    assert "degrees instead of radians?" in said


def test_body_rate_of_another_frame(doubted):
    said = doubted(lambda frame: frame.assign(body_rate_y=-frame["body_rate_y"]), "quadrotor")
    assert said.startswith(
        "Channel 'body_rate_y' runs against the rate of change of 'attitude' (correlation -1.00)"
    )
    assert "another sign or frame?" in said


def test_attitude_from_world_to_body(doubted):
    def conjugate(frame):
        axes = [f"attitude_{axis}" for axis in "xyz"]
        frame[axes] *= -1
        return frame

    assert "'body_rate_x' runs against the rate of change of 'attitude'" in doubted(conjugate, "quadrotor")


def test_the_sign_of_a_quaternion_does_not_matter(doubted):
    def flip(frame):
        axes = [f"attitude_{axis}" for axis in "wxyz"]
        frame.loc[::3, axes] *= -1
        return frame

    assert doubted(flip, "quadrotor") == ""


def test_joint_position_in_degrees(doubted):
    said = doubted(lambda frame: frame.assign(position=np.degrees(frame["position"])), samples=400)
    assert "degrees instead of radians? Convert 'position'" in said
    assert "swings over more than two turns" in said


def test_joint_wholly_in_degrees(doubted):
    def change(frame):
        return frame.assign(position=np.degrees(frame["position"]), velocity=np.degrees(frame["velocity"]))

    said = doubted(change, samples=400)
    assert said == (
        "Channel 'position' swings over more than two turns: is it in degrees? "
        "Convert it, or declare its unit in the Parquet file."
    )


def test_a_wheel_that_turns_on_raises_no_doubt(doubted):
    def change(frame):
        return frame.assign(position=100 * frame["t"] + frame["position"], velocity=100 + frame["velocity"])

    assert doubted(change) == ""


def test_steering_angle_in_degrees(doubted):
    said = doubted(lambda frame: frame.assign(steer_angle_2=np.degrees(frame["steer_angle_2"])), "swerve")
    assert "'steer_velocity_2'" in said
    assert "'steer_velocity_1'" not in said


def test_position_in_millimetres(doubted):
    said = doubted(lambda frame: frame.assign(position_z=1000 * frame["position_z"]), "quadrotor")
    assert "'velocity_z' is 0.001 times" in said
    assert "millimetres" in said


@pytest.mark.parametrize(
    ("scale", "words"), [(1 / 9.81, "in g instead of m/s²"), (-1.0, "z axis point down")]
)
def test_specific_force(doubted, scale, words):
    def change(frame):
        gravity = 9.81 + 0.1 * np.sin(frame["t"])
        return frame.assign(specific_force_x=np.sin(frame["t"]), specific_force_y=0.1 * gravity).assign(
            specific_force_z=scale * gravity
        )

    assert words in doubted(change, "quadrotor")


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


def test_commands_beyond_one(doubted):
    def change(frame):
        return frame.assign(**{f"motor_command_{rotor}": 40000 + frame["t"] for rotor in "1234"})

    assert "'motor_command_1' exceeds 1" in doubted(change, "quadrotor")


def test_voltages_in_millivolts(doubted):
    said = doubted(lambda frame: frame.assign(voltage=9000.0), samples=400)
    assert "Channel 'voltage' exceeds 1000 V: is it in millivolts?" in said
