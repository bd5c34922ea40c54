"""SysId files: tests and sides become runs, rotations become metres or radians."""

import json
import math

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.recordings.importers.sysid_json import read

STEP = [
    [0.0, 0, 0, 1.0, 2.0, 0.0, 0.0, 0, 0],
    [0.1, 7, 6, 1.1, 2.2, 1.0, 2.0, 0, 0],
    [0.2, 7, 6, 1.3, 2.6, 2.0, 4.0, 0, 0],
]
RAMP = [[0.0, 0, 1.0, 0.0], [0.1, 1, 1.5, 5.0], [0.2, 2, 2.5, 10.0]]


def _write(path, **content):
    path.write_text(json.dumps(content))
    return path


def test_both_sides_of_a_drivetrain(tmp_path):
    path = _write(tmp_path / "a.json", **{"fast-forward": STEP, "units": "Feet", "unitsPerRotation": 2.0})
    recording = read([path], {})
    assert recording.runs == ["fast-forward-left", "fast-forward-right"]
    assert recording.units["position"] == "m"
    right = recording.frame[recording.frame["run"] == "fast-forward-right"]
    np.testing.assert_allclose(right["position"], np.array([2.0, 2.2, 2.6]) * 2 * 0.3048)
    np.testing.assert_allclose(right["velocity"], np.array([0.0, 2.0, 4.0]) * 2 * 0.3048)
    np.testing.assert_allclose(right["voltage"], [0, 6, 6])


def test_what_is_in_units_already_is_not_scaled_again(tmp_path):
    path = _write(tmp_path / "a.json", **{"fast-forward": STEP, "units": "Meters", "unitsPerRotation": 0.25})
    frame = read([path], {"position": "units", "velocity": "rotations"}).frame
    np.testing.assert_allclose(frame["position"].iloc[:3], [1.0, 1.1, 1.3])
    np.testing.assert_allclose(frame["velocity"].iloc[:3], [0.0, 0.25, 0.5])


def test_a_single_axis_in_degrees(tmp_path):
    path = _write(
        tmp_path / "arm.json", **{"slow-forward": RAMP, "units": "Degrees", "unitsPerRotation": 360}
    )
    recording = read([path], {})
    assert recording.runs == ["slow-forward"]
    assert recording.units["position"] == "rad"
    np.testing.assert_allclose(recording.frame["velocity"], 2 * math.pi * np.array([0.0, 5.0, 10.0]))


def test_several_files_name_their_runs(tmp_path):
    paths = [
        _write(
            tmp_path / f"{name}.json", **{"slow-forward": RAMP, "units": "Rotations", "unitsPerRotation": 1}
        )
        for name in ("a", "b")
    ]
    assert read(paths, {}).runs == ["a-slow-forward", "b-slow-forward"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"units": "Meters"}, "holds no SysId test"),
        ({"slow-forward": RAMP, "units": "Cubits"}, "unknown units 'Cubits'"),
        ({"slow-forward": RAMP, "units": "Meters"}, "unitsPerRotation"),
        ({"slow-forward": [[1, 2]], "units": "Meters", "unitsPerRotation": 1}, "neither 4 nor 9"),
        ({"slow-forward": [["a"] * 4], "units": "Meters", "unitsPerRotation": 1}, "not numbers"),
        ({"slow-forward": [RAMP[1], RAMP[0]], "units": "Meters", "unitsPerRotation": 1}, "time goes back"),
    ],
)
def test_mistakes(tmp_path, content, words):
    with pytest.raises(InputError, match=words):
        read([_write(tmp_path / "a.json", **content)], {})


def test_no_json(tmp_path):
    (tmp_path / "a.json").write_text("{")
    with pytest.raises(InputError, match="cannot be read as JSON"):
        read([tmp_path / "a.json"], {})


def test_an_option_that_is_none_of_the_two(tmp_path):
    path = _write(tmp_path / "a.json", **{"slow-forward": RAMP, "units": "Meters", "unitsPerRotation": 1})
    with pytest.raises(InputError, match="'turns' is neither"):
        read([path], {"velocity": "turns"})


@pytest.mark.parametrize(
    ("name", "velocity", "tolerance"),
    [("swerve_drive_sim", "rotations", 0.002), ("swerve_drive", "units", 0.06)],
)
def test_the_velocity_integrates_to_the_position(shared_data, name, velocity, tolerance):
    """The real robot's velocity lags by over 0.1 s, which lets the slope exceed one by a few per cent."""
    recording = read([shared_data / name / "data.json"], {"position": "units", "velocity": velocity})
    for _, run in recording.frame.groupby("run"):
        time, speed = run["t"].to_numpy(), run["velocity"].to_numpy()
        travelled = np.concatenate([[0], np.cumsum(np.diff(time) * (speed[1:] + speed[:-1]) / 2)])
        slope = np.polyfit(travelled, run["position"], 1)[0]
        assert slope == pytest.approx(1.0, abs=tolerance)


def test_the_simulated_robot_has_its_published_feedforward(shared_data):
    """At constant speed V = kS + kV·v, with the published kS 0.11114 and kV 2.7851."""
    recording = read(
        [shared_data / "swerve_drive_sim" / "data.json"], {"position": "units", "velocity": "rotations"}
    )
    last = recording.frame[recording.frame["run"] == "fast-forward-left"].iloc[-1]
    assert last["voltage"] == pytest.approx(0.11114 + 2.7851 * last["velocity"], rel=0.01)
