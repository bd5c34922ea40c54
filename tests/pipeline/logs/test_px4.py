"""Logs of PX4: a simulated flight written as ULog comes back as it was; the real ones get the answer they deserve."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.logs.apply import recording_of
from simgap.logs.formats import read_log
from simgap.logs.layouts.airframes import X, directions
from simgap.logs.opening import open_recording
from simgap.logs.proposal import Proposal, propose
from tests.pipeline.logs import vehicle
from tests.pipeline.logs.ulog_encoder import ulog

QUAD = {"SYS_AUTOSTART": 4001, "MAV_TYPE": 2}
X_PLACES = np.array([[1, -1], [-1, 1], [1, 1], [-1, -1]])


def flown(**changed: dict) -> dict[str, dict[str, np.ndarray]]:
    """Return the topics of a flight, with the names of 1.14 and later; a change replaces or (None) removes one."""
    time = vehicle.stamps()
    flies = vehicle.airborne()
    vector = {
        name: np.stack([vehicle.ned(f"{name}_{axis}") for axis in axes], 1).astype("f4")
        for name, axes in (("attitude", "wxyz"), ("body_rate", "xyz"), ("specific_force", "xyz"))
    }
    commands = np.stack([vehicle.padded(f"motor_command_{rotor}", 0.1) for rotor in range(1, 5)], 1).astype(
        "f4"
    )
    local = {
        "x": vehicle.ned("position_x"), "y": vehicle.ned("position_y"), "z": vehicle.ned("position_z"),
        "vx": vehicle.ned("velocity_x"), "vy": vehicle.ned("velocity_y"), "vz": vehicle.ned("velocity_z"),
    }  # fmt: skip
    topics = {
        "vehicle_local_position": {"timestamp": time}
        | {name: values.astype("f4") for name, values in local.items()},
        "vehicle_attitude": {"timestamp": time, "q": vector["attitude"]},
        "vehicle_angular_velocity": {"timestamp": time, "xyz": vector["body_rate"]},
        "vehicle_acceleration": {"timestamp": time, "xyz": vector["specific_force"]},
        "actuator_motors": {"timestamp": time, "control": commands},
        "battery_status": {
            "timestamp": time[::20],
            "voltage_v": vehicle.padded("battery_voltage", 16.0)[::20].astype("f4"),
        },
        "vehicle_land_detected": {"timestamp": time, "landed": ~flies},
        "actuator_armed": {"timestamp": time, "armed": np.ones(len(time), dtype=bool)},
    }
    return {name: value for name, value in (topics | changed).items() if value is not None}


def written(folder: Path, topics: dict, parameters: dict | None = None, **options: object) -> Path:
    path = folder / "flight.ulg"
    path.write_bytes(ulog(topics, QUAD | (parameters or {}), vehicle.START, **options))
    return path


def proposed(path: Path, kind: str = "quadrotor") -> Proposal:
    return propose(read_log(path), kind)


def test_a_flight_comes_back_as_it_was(tmp_path: Path) -> None:
    recording = open_recording(written(tmp_path, flown()), "quadrotor")
    assert recording.runs == ["flight_1"]
    original = vehicle.flight()
    for column in recording.channels:
        if column != "battery_voltage":
            np.testing.assert_allclose(
                recording.frame[column], original[column], atol=2e-6, rtol=1e-6, err_msg=column
            )
    voltage = slice(-20)  # behind the last sample of the flight, at 5 Hz, it is between that and the ground
    np.testing.assert_allclose(
        recording.frame["battery_voltage"][voltage], original["battery_voltage"][voltage], atol=0.2
    )
    np.testing.assert_allclose(recording.frame["t"], original["t"], atol=1e-9)


def test_it_is_one_motion_under_gravity_and_its_motors_turn_it(tmp_path: Path) -> None:
    frame = open_recording(written(tmp_path, flown()), "quadrotor").frame
    vehicle.assert_one_motion(frame)
    vehicle.assert_motors_turn_it(frame, X_PLACES, directions(X))


def test_the_names_of_before_and_pulses(tmp_path: Path) -> None:
    time = vehicle.stamps()
    commands = np.stack([vehicle.padded(f"motor_command_{rotor}", 0.1) for rotor in range(1, 5)], 1)
    inertial = {
        "timestamp": time,
        "gyro_rad": np.stack([vehicle.ned(f"body_rate_{axis}") for axis in "xyz"], 1).astype("f4"),
        "accelerometer_m_s2": np.stack([vehicle.ned(f"specific_force_{axis}") for axis in "xyz"], 1).astype(
            "f4"
        ),
    }
    topics = flown(
        vehicle_angular_velocity=None,
        vehicle_acceleration=None,
        actuator_motors=None,
        sensor_combined=inertial,
        actuator_outputs={"timestamp": time, "output": (1075 + 875 * commands).astype("f4")},
    )
    recording = open_recording(written(tmp_path, topics, {"PWM_MIN": 1075, "PWM_MAX": 1950}), "quadrotor")
    for column in ("motor_command_3", "body_rate_y", "specific_force_z"):
        np.testing.assert_allclose(recording.frame[column], vehicle.flight()[column], atol=1e-4)


def test_pulses_without_a_range_are_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    pulses = {
        "timestamp": vehicle.stamps(),
        "output": np.full((len(vehicle.stamps()), 4), 1500.0, dtype="f4"),
    }
    path = written(tmp_path, flown(actuator_motors=None, actuator_outputs=pulses))
    assert not proposed(path).is_sure
    with pytest.raises(InputError, match=r"correct flight.ulg.mapping.yaml"):
        open_recording(path, "quadrotor")


def test_the_simulator_is_the_state_and_the_estimator_its_estimate(tmp_path: Path) -> None:
    topics = flown()
    for name in ("vehicle_local_position", "vehicle_attitude", "vehicle_angular_velocity"):
        topics[f"{name}_groundtruth"] = topics[name]
    topics["vehicle_local_position"] = topics["vehicle_local_position"] | {
        "x": topics["vehicle_local_position"]["x"] + 1
    }
    frame = open_recording(written(tmp_path, topics), "quadrotor").frame
    np.testing.assert_allclose(frame["position_x"], vehicle.flight()["position_x"], atol=1e-5)
    np.testing.assert_allclose(frame["estimate_position_x"], frame["position_x"] + 1, atol=1e-5)


def test_speeds_are_taken_by_the_motor_that_a_controller_drives(tmp_path: Path) -> None:
    time = vehicle.stamps()
    speeds = [vehicle.padded(f"motor_speed_{rotor}", 100.0) * 30 / np.pi for rotor in (2, 1, 3, 4)]
    esc = {"timestamp": time}
    for slot, (speed, motor) in enumerate(zip(speeds, (102, 101, 103, 104), strict=True)):
        esc |= {
            f"esc[{slot}].esc_rpm": np.round(speed).astype("i4"),
            f"esc[{slot}].actuator_function": np.full(len(time), motor, dtype="u1"),
        }
    frame = open_recording(written(tmp_path, flown(esc_status=esc)), "quadrotor").frame
    for rotor in range(1, 5):
        np.testing.assert_allclose(
            frame[f"motor_speed_{rotor}"], vehicle.flight()[f"motor_speed_{rotor}"], atol=0.06
        )


def test_the_geometry_of_the_log_is_told_in_the_frame_of_a_platform_file(tmp_path: Path) -> None:
    geometry = {}
    for rotor, (x, y, moment) in enumerate(
        [(0.1, 0.2, 0.05), (-0.1, -0.2, 0.05), (0.1, -0.2, -0.05), (-0.1, 0.2, -0.05)]
    ):
        geometry |= {f"CA_ROTOR{rotor}_PX": x, f"CA_ROTOR{rotor}_PY": y, f"CA_ROTOR{rotor}_KM": moment}
    notes = " ".join(proposed(written(tmp_path, flown(), geometry | {"CA_ROTOR_COUNT": 4})).notes)
    assert "[[0.1, -0.2, 0], [-0.1, 0.2, 0], [0.1, 0.2, 0], [-0.1, -0.2, 0]] m" in notes
    assert "rotor_directions [-1, -1, 1, 1]" in notes


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"MAV_TYPE": 22}, "of a VTOL"),
        ({"MAV_TYPE": 10}, "of a rover"),
        ({"CA_ROTOR_COUNT": 6}, "with 6 rotors"),
    ],
)
def test_another_vehicle_is_refused(tmp_path: Path, parameters: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        open_recording(written(tmp_path, flown(), parameters), "quadrotor")


def test_slow_motors_are_refused_and_a_slow_position_is_left_out(tmp_path: Path) -> None:
    topics = flown()
    slow = {name: {field: values[::10] for field, values in topic.items()} for name, topic in topics.items()}
    with pytest.raises(InputError, match=r"actuator_motors at 10 Hz.*logger_topics\.txt"):
        open_recording(written(tmp_path, topics | {"actuator_motors": slow["actuator_motors"]}), "quadrotor")
    path = written(tmp_path, topics | {"vehicle_local_position": slow["vehicle_local_position"]})
    found = proposed(path)
    assert not found.refusal
    assert "position_x" not in found.columns
    assert "at 10 Hz is too slow" in found.missing["position_x"]
    assert "attitude_w" not in found.columns  # they count together: the rotation is judged alone
    assert found.is_sure


def test_a_vehicle_that_stays_on_the_ground_is_refused(tmp_path: Path) -> None:
    topics = flown()
    still = {"timestamp": vehicle.stamps()} | {
        name: 0.05 * values
        for name, values in topics["vehicle_local_position"].items()
        if name != "timestamp"
    }
    with pytest.raises(InputError, match=r"nothing flies in it: the height changes by 0\.\d\d m only"):
        open_recording(written(tmp_path, topics | {"vehicle_local_position": still}), "quadrotor")
    never = {"timestamp": vehicle.stamps(), "armed": np.zeros(len(vehicle.stamps()), dtype=bool)}
    with pytest.raises(InputError, match="never armed"):
        open_recording(written(tmp_path, topics | {"actuator_armed": never}), "quadrotor")


def test_a_log_that_does_not_tell_when_it_flies_is_cut_by_its_height(tmp_path: Path) -> None:
    recording = open_recording(
        written(tmp_path, flown(vehicle_land_detected=None, actuator_armed=None)), "quadrotor"
    )
    assert len(recording.frame) == len(vehicle.flight())


def test_a_thrust_is_no_speed(tmp_path: Path) -> None:
    found = proposed(written(tmp_path, flown(), {"THR_MDL_FAC": 0.3}))
    assert not found.is_sure
    assert any("square root" in note for note in found.notes)


def test_a_log_of_a_vehicle_is_no_joint(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not of a joint"):
        open_recording(written(tmp_path, flown()), "joint")


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("ulog_pyulog_samples/sample_log_small.ulg", "of a VTOL (SYS_AUTOSTART 13014)"),
        ("ulog_pyulog_samples/sample_bench_AUAV_X21.ulg", "never armed"),
        ("ulog_pyulog_samples/sample_appended_multiple.ulg", "never armed"),
        ("ulog_pyulog_samples/sample_px4_events_SITL.ulg", "actuator_motors at 10 Hz"),
        ("ulog_roboto_bench/test.ulg", "nothing flies in it"),
    ],
)
def test_the_real_logs_are_refused_for_what_they_are(shared_data: Path, file: str, said: str) -> None:
    with pytest.raises(InputError) as raised:
        open_recording(shared_data / "raw" / file, "quadrotor")
    assert said in str(raised.value)


def test_the_simulated_hover_is_one_motion(shared_data: Path) -> None:
    log = read_log(shared_data / "raw/ulog_pyulog_samples/sample_px4_events_SITL.ulg")
    found = propose(log, "quadrotor")
    frame = recording_of(log, replace(found.mapping(), rate=20.0)).frame
    assert 5.0 < frame["t"].max() < 8.0  # some seconds between take-off and landing
    assert 1.9 < frame["position_z"].max() < 2.3
    climbing = frame["velocity_z"] > 0.5
    assert (np.diff(frame["position_z"])[climbing[1:-1].to_numpy().nonzero()[0]] > 0).all()
    up = frame["specific_force_z"] - 9.81
    assert np.corrcoef(up, np.gradient(frame["velocity_z"], frame["t"]))[0, 1] > 0.6
    assert abs(frame["specific_force_z"].median() - 9.81) < 0.1
    vertical = 1 - 2 * (frame["attitude_x"] ** 2 + frame["attitude_y"] ** 2)
    assert (vertical > 0.99).all()
