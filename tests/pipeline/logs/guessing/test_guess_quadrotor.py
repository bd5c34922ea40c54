"""Proposals for quadrotors and swerve drives: order of quaternions, units of rates, axes of an accelerometer."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from simgap.logs.apply import recording_of
from simgap.logs.guess import guess
from simgap.logs.proposal import SURE, Proposal
from simgap.logs.tabular import log_of_table

GRAVITY = np.array([0.0, 0.0, 9.81])
STEP = 0.01


def proposed(frame: pd.DataFrame) -> Proposal:
    return guess(log_of_table(frame, Path("log.csv"), "table"), None)


@pytest.fixture
def flight() -> dict[str, np.ndarray]:
    """A flight with tilts: exact kinematics in the contract's frames."""
    time = np.arange(1500) * STEP
    position = np.stack(
        [2 * np.sin(0.9 * time), 1.5 * np.sin(1.3 * time + 1), 1 + 0.4 * np.sin(0.7 * time)], axis=1
    )
    velocity = np.gradient(position, STEP, axis=0)
    acceleration = np.gradient(velocity, STEP, axis=0)
    angles = np.stack([0.5 * np.sin(1.1 * time), 0.3 * np.sin(1.7 * time), 0.6 * np.sin(2.1 * time)], axis=1)
    turned = Rotation.from_euler("ZYX", angles)
    rates = np.zeros((1500, 3))
    rates[1:-1] = (turned[:-2].inv() * turned[2:]).as_rotvec() / (2 * STEP)
    rates[0], rates[-1] = rates[1], rates[-2]
    force = turned.inv().apply(acceleration + GRAVITY)
    motors = 0.5 + 0.1 * np.sin(time[:, None] + np.arange(4))
    return {"t": time, "p": position, "v": velocity, "q": turned.as_quat(scalar_first=True), "w": rates, "a": force,
            "f": acceleration + GRAVITY, "m": motors}  # fmt: skip


def table(flight: dict[str, np.ndarray], **changed: np.ndarray) -> pd.DataFrame:
    content = flight | changed
    columns = {"t": content["t"]}
    for name, axes in (("p", "xyz"), ("v", "xyz"), ("q", "wxyz"), ("w", "xyz"), ("a", "xyz")):
        columns |= {f"{name}{axis}": content[name][:, place] for place, axis in enumerate(axes)}
    columns |= {f"motor{place + 1}": content["m"][:, place] for place in range(4)}
    return pd.DataFrame(columns)


def test_all_of_a_flight_in_si_units(flight: dict) -> None:
    proposal = proposed(table(flight))
    assert proposal.kind == "quadrotor"
    assert proposal.is_sure
    columns = proposal.columns
    assert columns["attitude_w"].source.signal == "qw"
    assert columns["specific_force_z"].source.signal == "az"
    assert [columns[f"motor_command_{number}"].source.signal for number in (1, 4)] == ["motor1", "motor4"]


def test_a_quaternion_of_numbers_has_its_scalar_where_the_rates_say(flight: dict) -> None:
    frame = table(flight).drop(columns=["qw", "qx", "qy", "qz"])
    for place, part in enumerate(np.roll(flight["q"], -1, axis=1).T):
        frame[f"quat[{place}]"] = part
    columns = proposed(frame).columns
    assert columns["attitude_w"].source.signal == "quat[3]"
    assert columns["attitude_x"].source.signal == "quat[0]"


def test_rates_in_degrees_and_of_another_frame(flight: dict) -> None:
    columns = proposed(table(flight, w=np.rad2deg(flight["w"]) * [1, -1, -1])).columns
    assert columns["body_rate_x"].source.unit == "deg/s"
    assert [columns[f"body_rate_{axis}"].source.sign for axis in "xyz"] == [1, -1, -1]


def test_an_accelerometer_in_g_and_one_in_axes_of_the_world(flight: dict) -> None:
    assert proposed(table(flight, a=flight["a"] / 9.80665)).columns["specific_force_x"].source.unit == "g"
    proposal = proposed(table(flight, a=flight["f"]))
    assert "specific_force_x" not in proposal.columns
    assert "axes of the world" in " ".join(proposal.notes)


def test_a_log_with_z_down_is_turned_into_the_frames_of_the_contract(flight: dict) -> None:
    """North, east, down and forward, right, down, as of a flight controller: a hover has its force up all the same."""
    down = np.array([1.0, -1.0, -1.0])
    frame = table(
        flight, p=flight["p"] * down, v=flight["v"] * down, w=flight["w"] * down, a=flight["a"] * down,
        q=flight["q"] * [1, 1, -1, -1],
    )  # fmt: skip
    log = log_of_table(frame, Path("log.csv"), "table")
    recording = recording_of(log, guess(log, None).mapping())
    for column, values in (
        ("position", flight["p"]),
        ("velocity", flight["v"]),
        ("body_rate", flight["w"]),
        ("specific_force", flight["a"]),
    ):
        found = recording.frame[[f"{column}_{axis}" for axis in "xyz"]].to_numpy()
        np.testing.assert_allclose(found, values, atol=1e-9)
    found = recording.frame[[f"attitude_{axis}" for axis in "wxyz"]].to_numpy()
    np.testing.assert_allclose(found, flight["q"], atol=1e-9)
    assert recording.frame["specific_force_z"].median() == pytest.approx(9.81, abs=1.0)


def test_pulses_and_numbers_of_sixteen_bits_are_commands_from_0_to_1(flight: dict) -> None:
    pulses = proposed(table(flight, m=1000 + 1000 * flight["m"])).columns["motor_command_1"].source
    assert 1500 * pulses.scale + pulses.offset == pytest.approx(0.5)
    raw = proposed(table(flight, m=65535 * flight["m"])).columns["motor_command_1"]
    assert 65535 * raw.source.scale == pytest.approx(1.0)
    assert raw.confidence < SURE


def test_a_proposal_for_pulses_that_name_their_unit_is_taken(flight: dict) -> None:
    names = {f"motor{rotor}": f"esc{rotor}_pwm_us" for rotor in (1, 2, 3, 4)}
    log = log_of_table(
        table(flight, m=1000 + 1000 * flight["m"]).rename(columns=names), Path("log.csv"), "table"
    )
    recording = recording_of(log, guess(log, None).mapping())
    found = recording.frame[[f"motor_command_{rotor}" for rotor in (1, 2, 3, 4)]].to_numpy()
    np.testing.assert_allclose(found, flight["m"], atol=1e-9)


def test_a_quaternion_without_motors_is_no_quadrotor(flight: dict) -> None:
    frame = table(flight).drop(columns=[f"motor{number}" for number in (1, 2, 3, 4)])
    assert proposed(frame).kind != "quadrotor"


def test_a_swerve_drive_by_the_names_of_its_modules() -> None:
    time = np.arange(400) * 0.02
    columns = {"Timestamp (s)": time}
    for module in ("FL", "FR", "BL", "BR"):
        for motor, quantities in (
            ("Drive", ("Voltage (V)", "Velocity (rad/s)")),
            ("Steer", ("Voltage (V)", "Velocity (deg/s)", "Angle (deg)")),
        ):
            columns |= {f"{module} {motor} {what}": np.sin(time + len(columns)) for what in quantities}
    proposal = proposed(pd.DataFrame(columns))
    assert proposal.kind == "swerve"
    assert proposal.is_sure
    assert proposal.columns["steer_angle_2"].source.signal == "FR Steer Angle (deg)"
    assert proposal.columns["drive_velocity_3"].source.signal == "BL Drive Velocity (rad/s)"


@pytest.mark.parametrize(("unit", "size"), [("g", 9.80665), ("mg", 9.80665e-3), ("m_s2", 1.0)])
def test_an_accelerometer_is_taken_in_the_unit_of_its_name(flight: dict, unit: str, size: float) -> None:
    names = {f"a{axis}": f"acc_{axis}_{unit}" for axis in "xyz"}
    log = log_of_table(table(flight, a=flight["a"] / size).rename(columns=names), Path("log.csv"), "table")
    proposal = guess(log, None)
    assert proposal.columns["specific_force_x"].source.signal == f"acc_x_{unit}"
    assert proposal.is_sure
    found = recording_of(log, proposal.mapping()).frame[[f"specific_force_{axis}" for axis in "xyz"]]
    np.testing.assert_allclose(found, flight["a"], rtol=1e-9, atol=1e-9)


def test_an_accelerometer_whose_name_contradicts_gravity_is_asked_about(flight: dict) -> None:
    found = proposed(table(flight).rename(columns={f"a{axis}": f"acc_{axis}_g" for axis in "xyz"}))
    assert found.columns["specific_force_z"].source.unit == "m/s²"
    assert found.columns["specific_force_z"].confidence < SURE


def test_centimetres_and_metres_a_second_fit_each_other(flight: dict) -> None:
    names = {f"p{axis}": f"pos_{axis}_cm" for axis in "xyz"}
    found = proposed(table(flight, p=100.0 * flight["p"]).rename(columns=names))
    assert found.columns["position_x"].source.unit == "cm"
    assert found.is_sure


def test_currents_of_motors_are_no_commands(flight: dict) -> None:
    names = {f"motor{rotor}": f"motor{rotor}_current_A" for rotor in (1, 2, 3, 4)}
    assert "motor_command_1" not in proposed(table(flight).rename(columns=names)).columns


def as_down(vectors: np.ndarray) -> np.ndarray:
    """Return vectors of north, west, up as north, east, down; the same turns forward, left, up."""
    return vectors * np.array([1.0, -1.0, -1.0])


def down(flight: dict[str, np.ndarray], **names: str) -> pd.DataFrame:
    """Return a flight as a person logs it in north, east, down: angles and rates in degrees, acceleration in g."""
    quaternion = np.column_stack([flight["q"][:, :1], as_down(flight["q"][:, 1:])])
    turned = Rotation.from_quat(quaternion, scalar_first=True)
    yaw, pitch, roll = turned.as_euler("ZYX", degrees=True).T
    columns = {"time_s": flight["t"], "roll_deg": roll, "pitch_deg": pitch, "yaw_deg": yaw}
    for stem, content, unit in (
        ("pos", flight["p"], "m"),
        ("vel", flight["v"], "m_s"),
    ):
        columns |= {f"{stem}_{axis}_{unit}": as_down(content)[:, place] for place, axis in enumerate("ned")}
    columns |= {
        f"gyro_{axis}_dps": np.rad2deg(as_down(flight["w"]))[:, place] for place, axis in enumerate("xyz")
    }
    columns |= {f"acc_{axis}_g": as_down(flight["a"])[:, place] / 9.80665 for place, axis in enumerate("xyz")}
    columns |= {f"motor{place + 1}": flight["m"][:, place] for place in range(4)}
    return pd.DataFrame(columns).rename(columns=names)


def test_a_flight_in_north_east_down_with_angles_in_degrees(flight: dict) -> None:
    log = log_of_table(down(flight), Path("log.csv"), "table")
    proposal = guess(log, None)
    assert proposal.is_sure
    frame = recording_of(log, proposal.mapping()).frame
    for column, content in (
        ("position", "p"),
        ("velocity", "v"),
        ("body_rate", "w"),
        ("specific_force", "a"),
    ):
        found = frame[[f"{column}_{axis}" for axis in "xyz"]]
        np.testing.assert_allclose(found, flight[content], rtol=1e-9, atol=1e-9)
    found = frame[[f"attitude_{axis}" for axis in "wxyz"]].to_numpy()
    aligned = np.abs((found * flight["q"]).sum(axis=1))
    np.testing.assert_allclose(aligned, 1.0, atol=1e-12)


def test_an_angle_of_another_sign_is_asked_about(flight: dict) -> None:
    """A pitch that counts nose down as positive makes a mirror image of the attitude."""
    frame = down(flight)
    columns = proposed(frame.assign(pitch_deg=-frame["pitch_deg"])).columns
    assert columns["attitude_w"].confidence < SURE
    mirrored = proposed(table(flight, w=flight["w"] * np.array([1.0, -1.0, 1.0]))).columns["attitude_w"]
    assert mirrored.confidence < SURE
    assert "mirrored" in mirrored.reason
    wrong = frame.assign(pitch_deg=frame["roll_deg"].to_numpy()[::-1])
    assert proposed(wrong).columns["attitude_w"].confidence < SURE


def test_without_an_accelerometer_a_frame_that_points_down_is_asked_about(flight: dict) -> None:
    frame = down(flight).drop(columns=[f"acc_{axis}_g" for axis in "xyz"])
    columns = proposed(frame).columns
    assert [columns[f"position_{axis}"].source.sign for axis in "xyz"] == [1, -1, -1]
    assert [columns[f"body_rate_{axis}"].source.sign for axis in "xyz"] == [1, -1, -1]
    assert columns["position_z"].confidence >= SURE > columns["attitude_w"].confidence
    assert "as in the position's name" in columns["attitude_w"].reason


def test_east_north_up_are_x_y_and_z(flight: dict) -> None:
    names = {
        f"{stem}{axis}": f"{stem}{place}" for stem in "pv" for axis, place in zip("xyz", "enu", strict=True)
    }
    proposal = proposed(table(flight).rename(columns=names))
    assert proposal.is_sure
    assert [proposal.columns[f"velocity_{axis}"].source.signal for axis in "xyz"] == ["ve", "vn", "vu"]
    assert [proposal.columns[f"velocity_{axis}"].source.sign for axis in "xyz"] == [1, 1, 1]


def test_an_accelerometer_is_known_on_a_fast_flight_too(flight: dict) -> None:
    """Of a hover the median is 1 g; here the whole flight pulls up."""
    lift = np.array([0.0, 0.0, 4.0])
    turned = Rotation.from_quat(flight["q"], scalar_first=True)
    velocity = flight["v"] + flight["t"][:, None] * lift
    changed = {
        "v": velocity,
        "p": flight["p"] + 0.5 * flight["t"][:, None] ** 2 * lift,
        "a": flight["a"] + turned.inv().apply(lift),
    }
    assert proposed(table(flight, **changed)).columns["specific_force_x"].confidence >= SURE


def test_drive_speeds_in_inches_a_second_become_those_of_the_motors() -> None:
    time = np.arange(400) * 0.02
    columns: dict[str, np.ndarray] = {"t_s": time, "battery_V": 12.0 - 0.1 * np.abs(np.sin(time))}
    for module in ("fl", "fr", "bl", "br"):
        columns |= {f"{module}_drive_V": np.sin(time), f"{module}_drive_vel_in_s": 100.0 * np.sin(time),
                    f"{module}_steer_V": np.cos(time), f"{module}_steer_angle_deg": 90.0 * np.sin(time),
                    f"{module}_steer_vel_dps": 90.0 * np.cos(time)}  # fmt: skip
    log = log_of_table(pd.DataFrame(columns), Path("log.csv"), "table")
    proposal = guess(log, None)
    assert proposal.is_sure
    assert proposal.columns["battery_voltage"].source.signal == "battery_V"
    platform = {"wheel_radius": 0.05, "drive": {"gear_ratio": 6.0}}
    found = recording_of(log, proposal.mapping(), platform).frame["drive_velocity_1"]
    np.testing.assert_allclose(found, 2.54 * np.sin(time) / 0.05 * 6.0)
