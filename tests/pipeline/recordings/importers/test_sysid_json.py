"""SysId files: tests and sides become runs, rotations become metres or radians."""

import json
import math

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.recordings.importers.sysid_json import read
from simgap.recordings.importers.sysid_units import UNITS, scale_of

STEP = [
    [0.0, 0, 0, 1.0, 2.0, 0.0, 0.0, 0, 0],
    [0.1, 7, 6, 1.1, 2.2, 1.0, 2.0, 0, 0],
    [0.2, 7, 6, 1.3, 2.6, 2.0, 4.0, 0, 0],
]
RAMP = [[0.0, 0, 1.0, 0.0], [0.1, 1, 1.5, 5.0], [0.2, 2, 2.5, 10.0]]
ROTATIONS = {"position": "rotations", "velocity": "rotations"}


def _write(path, **content):
    path.write_text(json.dumps(content))
    return path


def test_both_sides_of_a_drivetrain(tmp_path):
    path = _write(tmp_path / "a.json", **{"fast-forward": STEP, "units": "Feet", "unitsPerRotation": 2.0})
    recording = read([path], ROTATIONS)
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
    recording = read([path], ROTATIONS)
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
    assert read(paths, ROTATIONS).runs == ["a-slow-forward", "b-slow-forward"]


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
        read([_write(tmp_path / "a.json", **content)], ROTATIONS)


def _axis(speed: float, position: float, velocity: float) -> dict[str, list[list[float]]]:
    """Return tests of an axis that reaches a speed at 12 V, with its numbers multiplied by two factors."""
    gain, lag = 12.0 / speed, 0.1
    time = np.arange(0.0, 2.0, 0.005)
    tests = {}
    for name, volts in (("fast-forward", 7.0), ("fast-backward", -7.0)):
        rate = volts / gain * (1.0 - np.exp(-time / lag))
        place = volts / gain * (time - lag * (1.0 - np.exp(-time / lag)))
        tests[name] = np.column_stack(
            [time, np.full(len(time), volts), position * place, velocity * rate]
        ).tolist()
    return tests


@pytest.mark.parametrize(
    ("units", "per_rotation", "speed", "sorts"),
    [
        ("Meters", 0.3, 4.0, ("units", "rotations")),
        ("Meters", 0.3, 4.0, ("rotations", "units")),
        ("Degrees", 360.0, 30.0, ("rotations", "rotations")),  # degrees would be 5 degrees a second
        ("Degrees", 360.0, 300.0, ("units", "units")),  # rotations would be a million turns a minute
        ("Rotations", 1.0, 300.0, ("units", "units")),
        ("Inches", 400.0, 0.5, ("units", "units")),  # 200 m/s
    ],
)
def test_the_numbers_say_what_they_are(tmp_path, units, per_rotation, speed, sorts):
    factor = UNITS[units][1]
    scales = [scale_of(sort, factor, per_rotation) for sort in sorts]
    tests = _axis(speed, *(1.0 / scale for scale in scales))
    path = _write(tmp_path / "a.json", **tests, units=units, unitsPerRotation=per_rotation)
    frame = read([path], {}).frame
    last = frame[frame["run"] == "fast-forward"].iloc[-1]
    assert last["velocity"] == pytest.approx(7.0 / 12.0 * speed, rel=1e-6)
    assert last["position"] == pytest.approx(7.0 / 12.0 * speed * (last["t"] - 0.1), rel=1e-6)


def test_numbers_with_two_readings_are_refused(tmp_path):
    path = _write(tmp_path / "a.json", **_axis(4.0, 1.0, 1.0), units="Meters", unitsPerRotation=0.3)
    with pytest.raises(
        InputError, match=r"may be rotations \(1.2 m/s at 12 V\) or meters \(4 m/s"
    ) as refused:
        read([path], {})
    assert "dataset.options.position" in str(refused.value)
    frame = read([path], {"position": "units"}).frame
    assert frame["velocity"].max() == pytest.approx(7.0 / 3.0, rel=1e-3)


def test_a_velocity_that_is_no_rate_of_change_is_refused(tmp_path):
    path = _write(tmp_path / "a.json", **_axis(4.0, 1.0, 0.6), units="Meters", unitsPerRotation=0.3)
    with pytest.raises(InputError, match=r"the position changes by 1.67 of what the velocity says"):
        read([path], {})


def test_the_real_drive_in_metres_is_not_taken_for_rotations(shared_data):
    with pytest.raises(InputError, match=r"rotations \(1.3 m/s at 12 V\) or meters \(4.4 m/s at 12 V\)"):
        read([shared_data / "swerve_drive" / "data.json"], {})
    simulated = read([shared_data / "swerve_drive_sim" / "data.json"], {}).frame
    assert simulated["velocity"].max() == pytest.approx(2.47, abs=0.05)


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
