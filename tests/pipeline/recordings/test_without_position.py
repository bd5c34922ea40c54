"""Quadrotor recordings of a flight controller: rates, motors, accelerometer, but no position."""

import numpy as np
import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.recordings.cleaning import clean_recording
from simgap.recordings.contract import TOGETHER, required_channels
from simgap.recordings.recording import recording_from_frame, recording_from_table
from simgap.recordings.storage import Table


def flight(seconds: float = 8.0, runs: int = 2) -> pd.DataFrame:
    time = np.arange(0.0, seconds, 0.01)
    random = np.random.default_rng(0)
    columns = {f"body_rate_{axis}": np.sin(time + place) for place, axis in enumerate("xyz")}
    columns |= {f"motor_command_{n}": 0.5 + 0.1 * np.sin(3.0 * time + n) for n in range(1, 5)}
    return pd.concat(
        [
            pd.DataFrame(columns)
            .add(0.01 * random.standard_normal((len(time), 7)))
            .assign(run=f"run {run}", t=time)
            for run in range(runs)
        ],
        ignore_index=True,
    )


def with_state(frame: pd.DataFrame) -> pd.DataFrame:
    time = frame["t"]
    state = dict.fromkeys(TOGETHER["quadrotor"], 0.0) | {"attitude_w": 1.0, "position_z": 1.0}
    return frame.assign(**state).assign(position_x=np.sin(time), velocity_x=np.cos(time))


def test_what_is_known_of_the_state_is_whole_or_absent():
    rates = [f"body_rate_{axis}" for axis in "xyz"]
    assert required_channels("quadrotor", ["t", *rates]) == rates
    assert set(required_channels("quadrotor", ["velocity_x"])) == {*TOGETHER["quadrotor"], *rates}
    assert required_channels("joint", []) == ["position"]


def test_a_flight_without_position_is_read_with_a_word_on_what_it_cannot_show():
    recording = recording_from_frame(flight(), "quadrotor")
    assert "position_x" not in recording.frame
    (said,) = (text for text in recording.warnings if "were not recorded" in text)
    assert "Drag, wind, ground effect" in said
    assert "thrust along body z" not in said
    assert not [
        text for text in recording_from_frame(with_state(flight()), "quadrotor").warnings if "Drag" in text
    ]


def test_an_accelerometer_shows_the_thrust_as_well():
    force = {f"specific_force_{axis}": np.linspace(9.0, 10.0, len(flight())) for axis in "xyz"}
    recording = recording_from_frame(flight().assign(**force), "quadrotor")
    assert any("the thrust along body z can be judged" in text for text in recording.warnings)


def test_its_kind_is_known_by_its_columns():
    assert recording_from_table(Table(flight(), {}, {}, ())).kind == "quadrotor"


@pytest.mark.parametrize("column", ["position_y", "attitude_w", "velocity_z"])
def test_a_part_of_the_state_is_refused(column):
    with pytest.raises(InputError, match=f"'{column}' is missing.*leave all of") as refused:
        recording_from_frame(with_state(flight()).drop(columns=column), "quadrotor")
    assert "\n" not in str(refused.value)


def test_body_rates_are_always_needed():
    with pytest.raises(InputError, match="'body_rate_y' is missing"):
        recording_from_frame(flight().drop(columns="body_rate_y"), "quadrotor")


def test_cleaning_cuts_rotors_that_stand_and_what_follows_a_crash():
    frame = flight(12.0, runs=1)
    motors = [f"motor_command_{n}" for n in range(1, 5)]
    frame.loc[frame["t"] < 2.0, motors] = 0.02
    tumbling = frame["t"] > 11.85
    frame.loc[tumbling, "body_rate_x"] += 30.0 * np.sin(40.0 * frame.loc[tumbling, "t"])
    cleaned, changes = clean_recording(recording_from_frame(frame, "quadrotor"))
    assert cleaned.frame["t"].min() == pytest.approx(2.0, abs=0.02)
    assert cleaned.frame["t"].max() < 11.85
    assert {"rotors off", "crashed or lost control"} <= set(changes["reason"])
