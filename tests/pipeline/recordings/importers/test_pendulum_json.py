"""Pendulum logs: signed duty cycles become volts, and where the servo is off no voltage is claimed."""

import json

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.recordings.importers.pendulum_json import read

HEADER = {"mass": 0.49, "length": 0.1, "kp": 100, "vin": 8.85, "motor": "xl330", "trajectory": "sin_sin"}


def _entry(time, load, switched_on=True):
    return {
        "position": 0.1 * time,
        "speed": 0.1,
        "load": load,
        "input_volts": 7.3,
        "temp": 30,
        "timestamp": time,
        "goal_position": 0.0,
        "torque_enable": switched_on,
    }


def _log(path, entries, **header):
    path.write_text(json.dumps(HEADER | header | {"entries": entries}))
    return path


def test_the_duty_cycle_is_signed_and_times_the_supply(tmp_path):
    loads = [0, 100, 885, 65536 - 100, 65536 - 885]
    recording = read([_log(tmp_path / "a.json", [_entry(0.1 * i, load) for i, load in enumerate(loads)])], {})
    np.testing.assert_allclose(recording.frame["voltage"], [0.0, 1.0, 8.85, -1.0, -8.85], atol=1e-12)
    assert recording.runs == ["sin_sin_kp100"]
    assert recording.units["temperature"] == "°C"


def test_an_open_bridge_has_no_known_voltage(tmp_path):
    entries = [_entry(0.0, 100), _entry(0.1, 0, False), _entry(0.2, 0, False), _entry(0.3, 100)]
    recording = read([_log(tmp_path / "a.json", entries)], {})
    np.testing.assert_allclose(recording.frame["voltage"], [1.0, np.nan, np.nan, 1.0])
    assert any("switched off in a part of 1 runs" in warning for warning in recording.warnings)


def test_runs_of_the_same_name_are_told_apart_by_their_files(tmp_path):
    entries = [_entry(0.0, 0), _entry(0.1, 1)]
    paths = [_log(tmp_path / f"{name}.json", entries) for name in "ab"]
    assert read(paths, {}).runs == ["sin_sin_kp100_a", "sin_sin_kp100_b"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "cannot be read as JSON"),
        ("[1, 2]", "'trajectory' is missing"),
        (json.dumps(HEADER), "'entries' is missing"),
        (json.dumps(HEADER | {"entries": []}), "holds no samples"),
        (
            json.dumps(HEADER | {"entries": [{"position": 0.0, "timestamp": 0.0}]}),
            "column 'speed' is missing",
        ),
    ],
)
def test_mistakes(tmp_path, content, words):
    path = tmp_path / "a.json"
    path.write_text(content)
    with pytest.raises(InputError, match=words):
        read([path], {})


@pytest.fixture(scope="module")
def published(shared_data):
    """All sixteen logs; the speed is moved by the 20 ms that the servo's own filter costs."""
    frame = read(sorted(shared_data.glob("servo_xl330/raw/*.json")), {}).frame
    parts = []
    for _, run in frame.groupby("run", sort=False):
        time = np.arange(run["t"].iloc[0], run["t"].iloc[-1] - 0.03, 0.005)
        speed = np.interp(time + 0.02, run["t"], run["velocity"])
        acceleration = np.convolve(np.gradient(speed, 0.005), np.full(7, 1 / 7), mode="same")
        columns = {name: np.interp(time, run["t"], run[name]) for name in ("position", "voltage")}
        parts.append(np.column_stack([acceleration, speed, columns["position"], columns["voltage"]])[10:-10])
    return np.concatenate(parts)


def test_what_swings_free_is_a_pendulum_that_hangs_at_zero(published):
    """m·g·l/I: between that of the weight alone, 98 1/s², and that with as much inertia in the rotor."""
    acceleration, speed, position, voltage = published.T
    free = np.isnan(voltage) & (np.abs(speed) > 0.3)
    matrix = np.column_stack([np.sin(position), speed, np.sign(speed)])[free]
    gains = np.linalg.lstsq(matrix, acceleration[free], rcond=None)[0]
    assert -98.1 < gains[0] < -49.0
    explained = 1 - np.var(acceleration[free] - matrix @ gains) / np.var(acceleration[free])
    assert explained > 0.9


def test_positive_voltage_lifts_in_the_positive_sense(published):
    """What the voltage does less the back-EMF lifts the weight and accelerates it."""
    acceleration, speed, position, voltage = published.T
    driven = np.isfinite(voltage) & (np.abs(speed) > 0.15)
    lifted = 0.0067 * acceleration + 0.49 * 9.81 * 0.1 * np.sin(position)
    matrix = np.column_stack([voltage, speed, np.sign(speed)])[driven]
    gains = np.linalg.lstsq(matrix, lifted[driven], rcond=None)[0]
    assert gains[0] > 0 > gains[1]
    # the data sheet's 0.354 N·m/A over 3.4 Ω, of which the gear train takes a part
    assert 0.5 < gains[0] / 0.104 < 1.0
