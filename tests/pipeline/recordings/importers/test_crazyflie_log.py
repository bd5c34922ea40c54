"""Binary logs of the micro-SD deck: bytes to columns, and flights whose state had to be dead-reckoned."""

import struct
import zlib

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.recordings.importers.crazyflie_log import read
from simgap.recordings.importers.event_log import read_event_log

VARIABLES = [f"{sensor}.{axis}(f)" for sensor in ("acc", "gyro") for axis in "xyz"]
VARIABLES += [f"motor.m{rotor}(I)" for rotor in "1234"]
FULL = 65535


def _event(time, gyro=(0.0, 0.0, 0.0), command=0):
    return struct.pack("<HQ6f4I", 65535, time, 0.0, 0.0, 1.0, *gyro, *[command] * 4)


def _log(path, events, version=2):
    names = b"".join(name.encode() + b"\0" for name in VARIABLES)
    header = struct.pack("<BHHH", 0xBC, version, 1, 65535) + b"fixedFrequency\0"
    body = header + struct.pack("<H", len(VARIABLES)) + names + b"".join(events)
    path.write_bytes(body + struct.pack("<I", zlib.crc32(body)))
    return path


def _rest_and_hover(path):
    bias = (1.0, -2.0, 0.5)
    return _log(path, [_event(1000 * i, bias, 0 if i < 100 else FULL // 2) for i in range(1100)])


def test_events_become_rows(tmp_path):
    log = read_event_log(_log(tmp_path / "log", [_event(5), _event(1005, (1, 2, 3), 7)]))
    assert list(log["timestamp"]) == [5, 1005]
    assert list(log["gyro.y"]) == [0.0, 2.0]
    assert list(log["motor.m4"]) == [0, 7]


def test_a_hovering_flight_stands_still_upright(tmp_path):
    recording = read([_rest_and_hover(tmp_path / "log")], {"flights": {"log": [[0.1, 1.1]]}})
    frame = recording.frame
    assert recording.runs == ["log"]
    np.testing.assert_allclose(frame["motor_command_1"], (FULL // 2) / FULL)
    np.testing.assert_allclose(frame["specific_force_z"], 9.80665)
    np.testing.assert_allclose(frame[[f"body_rate_{axis}" for axis in "xyz"]], 0.0, atol=1e-9)
    np.testing.assert_allclose(frame["attitude_w"], 1.0, atol=1e-9)
    np.testing.assert_allclose(frame[["velocity_x", "velocity_y"]], 0.0, atol=1e-6)
    assert any("dead-reckoned" in warning for warning in recording.warnings)


def test_each_window_is_a_run(tmp_path):
    flights = {"log": [[0.0995, 0.5], [0.5995, 1.0]]}
    recording = read([_rest_and_hover(tmp_path / "log")], {"flights": flights})
    assert recording.runs == ["log-1", "log-2"]
    assert recording.frame.groupby("run")["t"].min().tolist() == pytest.approx([0.1, 0.6])


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda content: content[:-60] + content[-10:], "its checksum is wrong"),
        (lambda content: b"\x00" + content[1:], "is not a log of the micro-SD deck"),
        (lambda content: b"", "is not a log of the micro-SD deck"),
    ],
)
def test_damaged_files(tmp_path, damage, words):
    path = _rest_and_hover(tmp_path / "log")
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(InputError, match=words):
        read_event_log(path)


def test_what_else_cannot_be_read(tmp_path):
    with pytest.raises(InputError, match="header cannot be read"):
        read_event_log(_log(tmp_path / "a", [_event(0)], version=3))
    with pytest.raises(InputError, match="whole event"):
        read_event_log(_log(tmp_path / "b", [_event(0)[:-1]]))
    with pytest.raises(InputError, match="whole event"):
        read_event_log(_log(tmp_path / "c", []))


@pytest.mark.parametrize(
    ("flights", "words"),
    [
        ({}, "names no windows"),
        ({"log": [[1, 2, 3]]}, "names no windows"),
        ({"log": [[50, 60]]}, r"\[50, 60\] holds no samples"),
    ],
)
def test_windows(tmp_path, flights, words):
    with pytest.raises(InputError, match=rf"dataset.options.flights.log: .*{words}"):
        read([_rest_and_hover(tmp_path / "log")], {"flights": flights})


def test_motors_that_turn_at_once_leave_no_rest(tmp_path):
    log = _log(tmp_path / "log", [_event(1000 * i, command=FULL) for i in range(100)])
    with pytest.raises(InputError, match="turn from the first sample"):
        read([log], {"flights": {"log": [[0, 1]]}})


def test_the_published_lag_is_in_the_recording(shared_data):
    """Commands through a lag of some 0.07 s and a polynomial explain the accelerometer; without it far less."""
    recording = read([shared_data / "crazyflie_thrust_lag" / "log10"], {"flights": {"log10": [[35, 65]]}})
    frame = recording.frame
    command = frame[[f"motor_command_{rotor}" for rotor in "1234"]].to_numpy()
    left = {}
    for lag in (0.0, 0.03, 0.05, 0.07, 0.09, 0.12):
        speed = _lagged(command, frame["t"].to_numpy(), lag)
        matrix = np.column_stack([(speed**2).sum(axis=1), speed.sum(axis=1), np.ones(len(speed))])[500:]
        force = frame["specific_force_z"].to_numpy()[500:]
        left[lag] = np.std(force - matrix @ np.linalg.lstsq(matrix, force, rcond=None)[0])
    assert min(left, key=lambda lag: left[lag]) == 0.07
    assert left[0.07] < 0.45 * left[0.0]


def _lagged(command, time, constant):
    if constant == 0.0:
        return command
    result = command.copy()
    share = 1.0 - np.exp(-np.diff(time) / constant)
    for row in range(1, len(command)):
        result[row] = result[row - 1] + share[row - 1] * (command[row] - result[row - 1])
    return result
