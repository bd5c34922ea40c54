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
