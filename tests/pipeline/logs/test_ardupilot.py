"""Logs of ArduPilot: a simulated flight written as DataFlash comes back; the real ones get the answer they deserve."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.logs.apply import recording_of
from simgap.logs.formats import read_log
from simgap.logs.layouts.airframes import ARDUPILOT, directions
from simgap.logs.opening import open_recording
from simgap.logs.proposal import Proposal, propose
from simgap.logs.readers.dataflash_mixer import nearest
from tests.pipeline.logs import vehicle
from tests.pipeline.logs.dataflash_encoder import dataflash, instances
from tests.pipeline.logs.test_px4 import X_PLACES

QUAD = {"FRAME_CLASS": 1, "FRAME_TYPE": 1, "MOT_PWM_MIN": 1000, "MOT_PWM_MAX": 2000} | {
    f"SERVO{channel}_FUNCTION": function for channel, function in ((1, 33), (2, 34), (3, 35), (4, 36))
}
TO_RPM = 30 / np.pi


def flown(**changed: tuple | None) -> dict[str, tuple]:
    """Return the messages of a flight as Copter 4.5 writes them; a change replaces or (None) removes one."""
    time, slow = vehicle.stamps(), {"TimeUS": vehicle.stamps()[::10]}
    state = {
        name: vehicle.ned(f"{column}_{axis}")
        for column, names in (("position", ("PN", "PE", "PD")), ("velocity", ("VN", "VE", "VD")))
        for name, axis in zip(names, "xyz", strict=True)
    }
    quaternion = {f"Q{part}": vehicle.ned(f"attitude_{axis}") for part, axis in enumerate("wxyz", 1)}
    messages = {
        "XKF1": ("QBffffff", instances({"TimeUS": time} | state)),
        "XKQ": ("QBffff", instances({"TimeUS": time} | quaternion)),
        "IMU": ("QBffffff", instances(*inertial())),
        "ESC": ("QBf", instances(*turning())),
        "RCOU": ("QHHHH", slow | {f"C{rotor}": np.full(len(slow["TimeUS"]), 1500) for rotor in range(1, 5)}),
        "BAT": ("QBf", instances(slow | {"Volt": vehicle.padded("battery_voltage", 16.0)[::10]})),
        "EV": ("QB", {"TimeUS": [time[0], *switched()], "Id": [10, 28, 18]}),
    }
    return {name: value for name, value in (messages | changed).items() if value is not None}


def inertial() -> tuple[dict[str, np.ndarray], ...]:
    """Return what two inertial units measure; the second is not to be used."""
    first = {"TimeUS": vehicle.stamps()} | {
        f"{name}{axis.upper()}": vehicle.ned(f"{column}_{axis}")
        for name, column in (("Gyr", "body_rate"), ("Acc", "specific_force"))
        for axis in "xyz"
    }
    return first, first | {"AccX": first["AccX"] + 1}


def turning() -> list[dict[str, np.ndarray]]:
    """Return the speeds of the motors, turns per minute."""
    speeds = [vehicle.padded(f"motor_speed_{rotor}", 100.0) for rotor in range(1, 5)]
    return [{"TimeUS": vehicle.stamps(), "RPM": TO_RPM * speed} for speed in speeds]


def switched() -> np.ndarray:
    """Return when the vehicle says that it takes off and that it has landed, µs."""
    return vehicle.stamps()[np.flatnonzero(np.diff(vehicle.airborne().astype(int))) + 1]


UNITS = {"XKF1": "-#------", "XKQ": "-#----", "IMU": "-#------", "ESC": "-#-", "BAT": "-#v"}


def written(folder: Path, messages: dict, parameters: dict | None = None, **options: object) -> Path:
    path = folder / "flight.bin"
    own = {name: letters for name, letters in UNITS.items() if name in messages}
    path.write_bytes(dataflash(messages, QUAD | (parameters or {}), units=own, **options))
    return path


def proposed(path: Path) -> Proposal:
    return propose(read_log(path), "quadrotor")


def test_a_flight_comes_back_as_it_was(tmp_path: Path) -> None:
    recording = open_recording(written(tmp_path, flown()), "quadrotor")
    assert recording.runs == ["flight_1"]
    original = vehicle.flight()
    assert "motor_command_1" not in recording.channels  # at 10 Hz
    for column in recording.channels:
        if column != "battery_voltage":
            np.testing.assert_allclose(
                recording.frame[column], original[column], atol=3e-6, rtol=1e-6, err_msg=column
            )


def test_it_is_one_motion_under_gravity_and_its_motors_turn_it(tmp_path: Path) -> None:
    frame = open_recording(written(tmp_path, flown()), "quadrotor").frame
    vehicle.assert_one_motion(frame)
    speeds = {f"motor_command_{rotor}": frame[f"motor_speed_{rotor}"] for rotor in range(1, 5)}
    vehicle.assert_motors_turn_it(frame.assign(**speeds), X_PLACES, directions(ARDUPILOT[1]))


def test_the_attitude_of_angles_is_that_of_the_quaternion(tmp_path: Path) -> None:
    w, x, y, z = (vehicle.ned(f"attitude_{axis}") for axis in "wxyz")
    angles = {
        "TimeUS": vehicle.stamps(),
        "Roll": np.rad2deg(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
        "Pitch": np.rad2deg(np.arcsin(2 * (w * y - z * x))),
        "Yaw": np.rad2deg(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))) % 360,
    }
    path = written(tmp_path, flown(XKQ=None, ATT=("Qfff", angles)))
    assert proposed(path).columns["attitude_w"].source.signal == "ATT.quaternion.w"
    frame, original = open_recording(path, "quadrotor").frame, vehicle.flight()
    same = sum(frame[f"attitude_{axis}"] * original[f"attitude_{axis}"] for axis in "wxyz")
    np.testing.assert_allclose(np.abs(same), 1.0, atol=1e-6)
    assert np.ptp(np.sign(same)) == 0  # the sign of the quaternion does not jump where the yaw wraps


def test_pulses_of_old_firmware(tmp_path: Path) -> None:
    pulses = {"TimeMS": vehicle.stamps() // 1000} | {
        f"Ch{rotor}": 1100 + 800 * vehicle.padded(f"motor_command_{rotor}", 0.1) for rotor in range(1, 5)
    }
    messages = flown(ESC=None, RCOU=("Ihhhh", pulses))
    parameters = {"RC3_MIN": 1100, "RC3_MAX": 1900, "MOT_PWM_MIN": 0, "MOT_PWM_MAX": 0}
    frame = open_recording(written(tmp_path, messages, parameters), "quadrotor").frame
    np.testing.assert_allclose(frame["motor_command_2"], vehicle.flight()["motor_command_2"], atol=1e-3)


MIX = np.array([[-1, 1, 1, 1], [1, -1, 1, 1], [1, 1, -1, 1], [-1, -1, -1, 1]])
"""Of roll, pitch, yaw and throttle to the motors of an X."""


def controlled(unmixed: float = 0.0) -> dict[str, tuple]:
    """Return the outputs of the rate controller, and the pulses every fifth time, part of which it does not decide."""
    time = vehicle.stamps()
    pulses = 1000 + 1000 * np.stack(
        [vehicle.padded(f"motor_command_{rotor}", 0.1) for rotor in range(1, 5)], 1
    )
    outputs = pulses @ np.linalg.inv(MIX).T / 1000
    other = unmixed * np.random.default_rng(0).normal(size=pulses.shape)
    rate = {"TimeUS": time} | dict(zip(("ROut", "POut", "YOut", "AOut"), outputs.T, strict=True))
    slow = {"TimeUS": time[::5] - 100} | {
        f"C{rotor}": (pulses + other)[::5, rotor - 1] for rotor in range(1, 5)
    }
    return {"RATE": ("Qffff", rate), "RCOU": ("QHHHH", slow)}


def test_slow_pulses_are_computed_of_what_the_mixer_was_given(tmp_path: Path) -> None:
    path = written(tmp_path, flown(ESC=None, **controlled()))
    assert "RCOU at 20 Hz is too slow" in " ".join(proposed(path).notes)
    frame = open_recording(path, "quadrotor").frame
    for rotor in range(1, 5):
        command = vehicle.flight()[f"motor_command_{rotor}"]
        np.testing.assert_allclose(frame[f"motor_command_{rotor}"], command, atol=2e-3)


@pytest.mark.parametrize("factor", [1.0, 100.0])
def test_old_firmware_tells_rates_in_hundredths_of_a_degree(tmp_path: Path, factor: float) -> None:
    messages = flown(ESC=None, **controlled())
    letters, rate = messages["RATE"]
    asked = {
        name: factor * np.degrees(3.0 * vehicle.ned(f"body_rate_{axis}"))
        for name, axis in zip(("RDes", "PDes", "YDes"), "xyz", strict=True)
    }
    asked["RDes"][len(asked["RDes"]) // 2] = factor * 300.0
    path = written(tmp_path, messages | {"RATE": (f"{letters}fff", rate | asked)})
    found = open_recording(path, "quadrotor").frame["body_rate_command_y"]
    np.testing.assert_allclose(found, 3.0 * vehicle.flight()["body_rate_y"], atol=1e-4)


def test_pulses_that_the_mixer_does_not_explain_are_not_computed(tmp_path: Path) -> None:
    found = proposed(written(tmp_path, flown(ESC=None, **controlled(unmixed=50.0))))
    assert "RCOU at 20 Hz" in found.refusal


def test_motors_at_ten_hertz_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"RCOU at 10 Hz.*SERVO_BLH_BDMASK"):
        open_recording(written(tmp_path, flown(ESC=None)), "quadrotor")


def test_a_crash_ends_a_flight(tmp_path: Path) -> None:
    crash = int(vehicle.stamps()[0] + 1e6 * (vehicle.GROUND + 2.5))
    path = written(tmp_path, flown(ERR=("QBB", {"TimeUS": [crash], "Subsys": [12], "ECode": [1]})))
    assert open_recording(path, "quadrotor").frame["t"].max() == pytest.approx(2.5, abs=0.02)


@pytest.mark.parametrize(
    ("parameters", "texts", "said"),
    [
        ({"FRAME_CLASS": 2}, ("ArduCopter V4.5.0",), "of a hexacopter"),
        ({}, ("ArduRover V4.5.0",), "of a rover"),
        ({"Q_ENABLE": 1}, ("ArduPlane V4.5.0",), "of a VTOL"),
        ({}, ("ArduCopter V3.2", "Frame: OCTA"), "with the frame OCTA"),
    ],
)
def test_another_vehicle_is_refused(tmp_path: Path, parameters: dict, texts: tuple, said: str) -> None:
    with pytest.raises(InputError, match=said):
        open_recording(written(tmp_path, flown(), parameters, texts=texts), "quadrotor")


def test_the_order_of_the_motors_is_that_of_the_frame(tmp_path: Path) -> None:
    plus = " ".join(proposed(written(tmp_path, flown(), {"FRAME_TYPE": 0})).notes)
    assert "1 right (CCW), 2 left (CCW), 3 front (CW), 4 rear (CW)" in plus
    assert "[[0, -], [0, +], [+, 0], [-, 0]]" in plus
    betaflight = " ".join(proposed(written(tmp_path, flown(), {"FRAME_TYPE": 12})).notes)
    assert "rotor_directions [1, -1, -1, 1]" in betaflight


@pytest.mark.parametrize("rotors", ARDUPILOT.values(), ids=map(str, ARDUPILOT))
def test_every_frame_can_turn_about_each_axis(rotors: tuple) -> None:
    """Four rotors at four places, of which two turn each way, and opposite ones the same."""
    assert len({angle for angle, _ in rotors}) == 4
    assert sum(directions(rotors)) == 0
    senses = dict(rotors)
    assert all(senses[angle] == senses[angle - 180 if angle > 0 else angle + 180] for angle in senses)


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("dataflash_erle_devs/copter_20141215_16.BIN", "RCOU at 10 Hz"),
        ("dataflash_erle_devs/rover_20140825_61.BIN", "of a rover (ArduRover v2.46beta2"),
        ("dataflash_modern_SITL/00000001.BIN", "nothing flies in it"),
        ("dataflash_modern_SITL/00000002.BIN", "nothing flies in it"),
    ],
)
def test_the_real_logs_are_refused_for_what_they_are(shared_data: Path, file: str, said: str) -> None:
    with pytest.raises(InputError) as raised:
        open_recording(shared_data / "raw" / file, "quadrotor")
    assert said in str(raised.value)


def test_the_pulses_of_a_real_flight_are_what_its_mixer_was_given(shared_data: Path) -> None:
    """Of a copter of 2015 without GPS, two flights of 45 and 50 s."""
    log = read_log(shared_data / "raw/dataflash_erle_devs/erlebrain2_first_flight.BIN")
    found = propose(log, "quadrotor")
    assert len(found.windows) == 2
    assert "RCOU at 10 Hz is too slow" in " ".join(found.notes)
    assert "no horizontal position" in found.missing["position_x"]
    flying = found.windows[0]
    for rotor in range(1, 5):
        told, computed = log.signals[f"RCOU.Ch{rotor}"], log.signals[f"RATE.RCOU.Ch{rotor}"]
        inside = (told.time > flying.begin) & (told.time < flying.end)
        error = told.values[inside] - nearest(computed, told.time[inside])
        assert np.median(np.abs(error)) < 2.0  # µs, of pulses that vary by 30
        assert np.std(told.values[inside]) > 30.0


def test_a_real_flight_is_one_motion(shared_data: Path) -> None:
    """Of a copter of 2014, 120 s in the air: refused for its motors, but what it has is right."""
    log = read_log(shared_data / "raw/dataflash_erle_devs/copter_20141215_16.BIN")
    found = propose(log, "quadrotor")
    (window,) = found.windows
    assert window.end - window.begin > 120
    flying = replace(found.mapping(), windows=(replace(window, end=window.begin + 100),), rate=10.0)
    frame = recording_of(log, flying).frame
    t = frame["t"].to_numpy()
    force = vehicle.turned(*(vehicle.columns(frame, name) for name in ("attitude", "specific_force")))
    for index, axis in enumerate("xyz"):
        speed = np.gradient(frame[f"position_{axis}"], t)
        assert np.corrcoef(frame[f"velocity_{axis}"], speed)[0, 1] > (
            0.95 if axis in "xy" else 0.5
        )  # z: a barometer drifts
        assert np.corrcoef(force[:, index], np.gradient(frame[f"velocity_{axis}"], t))[0, 1] > 0.9
    assert abs(frame["specific_force_z"].median() - 9.81) < 0.3
    heading = 2 * np.unwrap(np.arctan2(frame["attitude_z"], frame["attitude_w"]), period=np.pi)
    assert np.corrcoef(frame["body_rate_z"], np.gradient(heading, t))[0, 1] > 0.9
