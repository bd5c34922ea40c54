"""The proposals for logs of no known layout: what is proposed confidently is right."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.logs.guess import guess
from simgap.logs.proposal import SURE, Proposal
from simgap.logs.tabular import log_of_table
from simgap.recordings.units import conversion
from tests.pipeline.logs.guessing.naming import Made, make, motion

LOGS = 60  # with type checks at every call three seconds; 1000 give the same share


def proposed(frame: pd.DataFrame, kind: str | None = None) -> Proposal:
    return guess(log_of_table(frame, Path("log.csv"), "table"), kind)


def is_right(made: Made, proposal: Proposal, column: str) -> bool:
    if column not in made.columns:
        return False
    name, factor = made.columns[column]
    source = proposal.columns[column].source
    found = conversion(source.unit or "1")
    if source.signal != name or found is None:
        return False
    return source.sign * source.scale * found[1] == pytest.approx(factor)


def test_what_is_proposed_confidently_is_right() -> None:
    sure, right, whole = 0, 0, 0
    for seed in range(LOGS):
        made = make(np.random.default_rng(seed))
        proposal = proposed(made.frame)
        assert not proposal.refusal
        confident = [column for column, found in proposal.columns.items() if found.confidence >= SURE]
        sure += len(confident)
        right += sum(is_right(made, proposal, column) for column in confident)
        whole += proposal.is_sure
    print(f"{LOGS} logs: {sure} columns at {SURE} or more, {right} right; {whole} logs need no mapping file")
    assert right >= 0.99 * sure
    assert sure >= 3.5 * LOGS  # of four to five columns that there are
    assert whole >= 0.6 * LOGS  # a third has no units; there the derivative shows them half the time


@pytest.fixture
def moving() -> dict[str, np.ndarray]:
    """A joint's time in s, position in rad, velocity in rad/s and torque in N·m."""
    rng = np.random.default_rng(5)
    time, position, velocity = motion(rng, 800)
    effort = 0.3 * np.sign(velocity) + 0.05 * velocity
    return {"t": time, "p": position, "v": velocity, "e": effort}


# header of time, position, velocity, input and of a fifth column that is a trap; what is proposed of the input
HABITS = [
    (("axis0.time", "axis0.encoder.pos_estimate", "axis0.encoder.vel_estimate", "axis0.motor.torque", "x"), "effort"),
    (("Time", "Present_Position", "Present_Velocity", "Present_Torque", "Goal_Position"), "effort"),
    (("Timestamp", "/Arm/PositionRads", "/Arm/VelocityRadPerSec", "/Arm/AppliedVolts", "/Arm/TempCelsius"), "voltage"),
    (("Zeit [s]", "Winkel [rad]", "Geschwindigkeit [rad/s]", "Spannung [V]", "Nr"), "voltage"),
    (("time_s", "act_pos", "act_vel", "act_trq", "ref_pos"), "effort"),
    (("stamp", "q_meas[0]", "dq_meas[0]", "tau_meas[0]", "tau_des[0]"), "effort"),
    (("Time_s", "Shaft Position / rad", "Shaft Speed / rad/s", "Torque / N m", "Run Time Error"), "effort"),
    (("time", "left_wheel_position", "left_wheel_velocity", "left_wheel_voltage", "right_wheel_voltage"), "voltage"),
    (("t", "motor.angle", "motor.angularVelocity", "motor.voltageIn", "loop_time"), "voltage"),
]  # fmt: skip


@pytest.mark.parametrize(("names", "kind_of_input"), HABITS)
def test_names_as_software_writes_them(moving: dict, names: tuple[str, ...], kind_of_input: str) -> None:
    trap = np.random.default_rng(1).standard_normal(len(moving["t"]))
    frame = pd.DataFrame(dict(zip(names, (*moving.values(), trap), strict=True)))
    columns = proposed(frame).columns
    for column, name in zip(("t", "position", "velocity", kind_of_input), names[:4], strict=True):
        assert columns[column].source.signal == name
    assert names[4] not in {found.source.signal for found in columns.values() if found.confidence >= SURE}


def test_without_a_unit_nobody_is_sure(moving: dict) -> None:
    frame = pd.DataFrame({"t": moving["t"], "pos": moving["p"], "vel": moving["v"], "torque": moving["e"]})
    proposal = proposed(frame)
    assert not proposal.is_sure
    assert proposal.columns["position"].confidence < SURE


def test_a_velocity_that_runs_against_its_position_is_turned_but_not_sure(moving: dict) -> None:
    frame = pd.DataFrame(
        {"t": moving["t"], "pos_rad": moving["p"], "vel_rad_s": -moving["v"], "torque_nm": moving["e"]}
    )
    found = proposed(frame).columns["velocity"]
    assert found.source.sign == -1
    assert found.confidence < SURE


def test_a_counter_is_no_time_and_wrong_units_are_no_columns(moving: dict) -> None:
    frame = pd.DataFrame({"index": np.arange(800), "time_ms": np.round(1e3 * moving["t"]), "angle_deg": moving["p"],
                          "speed [V]": moving["v"], "torque_nm": moving["e"]})  # fmt: skip
    columns = proposed(frame).columns
    assert columns["t"].source.signal == "time_ms"
    assert columns["t"].source.unit == "ms"
    assert all(found.source.signal != "speed [V]" for found in columns.values())


def test_of_many_joints_that_which_moves_most(moving: dict) -> None:
    frame = pd.DataFrame({"time": moving["t"]})
    for joint, size in enumerate((0.2, 1.0, 1e-6)):
        frame[f"q[{joint}]"], frame[f"qd[{joint}]"] = size * moving["p"], size * moving["v"]
        frame[f"tau[{joint}]"] = size * moving["e"]
    proposal = proposed(frame)
    assert [proposal.columns[name].source.signal for name in ("position", "velocity", "effort")] == [
        "q[1]",
        "qd[1]",
        "tau[1]",
    ]
    assert "2 joints move: q[1]" in " ".join(proposal.notes)


def test_what_does_not_move_is_refused(moving: dict) -> None:
    noise = 1e-4 * np.random.default_rng(2).standard_normal((2, 800))
    frame = pd.DataFrame(
        {"t": moving["t"], "pos_rad": noise[0], "vel_rad_s": noise[1], "torque_nm": moving["e"]}
    )
    assert "nothing moves: 'pos_rad'" in proposed(frame).refusal


def test_a_duty_is_a_voltage_only_with_a_supply(moving: dict) -> None:
    frame = pd.DataFrame(
        {"t": moving["t"], "pos_rad": moving["p"], "vel_rad_s": moving["v"], "duty": moving["e"]}
    )
    assert "'duty' is a duty" in proposed(frame).missing["effort"]
    found = proposed(frame.assign(vbat_volts=12.0 - 0.1 * np.abs(moving["e"]))).columns["voltage"]
    assert (found.source.signal, found.source.times) == ("duty", "vbat_volts")
    assert found.confidence < SURE


def test_a_raw_current_and_a_target_are_no_effort(moving: dict) -> None:
    frame = pd.DataFrame({"t": moving["t"], "pos_rad": moving["p"], "vel_rad_s": moving["v"]})
    assert (
        "is a current: give effort"
        in proposed(frame.assign(**{"current (units)": moving["e"]})).missing["effort"]
    )
    assert "log what the controller gives" in proposed(frame).missing["effort"]


@pytest.mark.parametrize("follows", [True, False])
def test_a_target_is_one_that_the_position_follows(moving: dict, follows: bool) -> None:
    late = np.concatenate([moving["p"][3:], moving["p"][-3:]])
    target = late if follows else np.random.default_rng(0).permutation(late)
    frame = pd.DataFrame(
        {"t": moving["t"], "pos_rad": moving["p"], "vel_rad_s": moving["v"], "goal_pos_rad": target}
    )
    found = proposed(frame).columns["position_command"]
    assert (found.confidence >= SURE) == follows, found.reason


def test_a_torque_of_sixteen_bits_without_sign_is_not_believed(moving: dict) -> None:
    load = np.round(300 * moving["e"]) % 65536
    frame = pd.DataFrame({"t": moving["t"], "pos_rad": moving["p"], "vel_rad_s": moving["v"], "load": load})
    found = proposed(frame).columns["effort"]
    assert found.confidence < 0.5
    assert "16 bits" in found.reason


def test_a_wheel_without_position_is_integrated_if_a_person_agrees(moving: dict) -> None:
    frame = pd.DataFrame({"t": moving["t"], "speed (rpm)": 10 * moving["v"], "volts (V)": moving["e"]})
    found = proposed(frame).columns["position"]
    assert found.source.integrate
    assert found.confidence < SURE


def test_signals_without_names_are_known_by_their_behaviour(moving: dict) -> None:
    frame = pd.DataFrame({"time_sec": moving["t"], "a": moving["v"], "b": moving["p"], "c_nm": moving["e"]})
    columns = proposed(frame).columns
    assert (columns["position"].source.signal, columns["velocity"].source.signal) == ("b", "a")
    assert columns["position"].confidence < SURE


def test_of_whole_seconds_and_a_full_stamp_the_stamp_is_the_time(moving: dict) -> None:
    stamp = 1.7e9 + moving["t"]
    frame = pd.DataFrame({"header.stamp.sec": np.floor(stamp), "header.stamp.nanosec": np.round(1e9 * (stamp % 1)),
                          "pos_rad": moving["p"], "vel_rad_s": moving["v"], "torque_nm": moving["e"]})  # fmt: skip
    assert proposed(frame).columns["t"].source.signal == "header.stamp"


def test_a_log_of_another_kind_of_machine_says_so(moving: dict) -> None:
    frame = pd.DataFrame(
        {"t": moving["t"], "pos_rad": moving["p"], "vel_rad_s": moving["v"], "torque_nm": moving["e"]}
    )
    assert proposed(frame, "swerve").refusal.startswith(
        "looks like the log of a joint, not of a swerve: give"
    )
    assert proposed(frame[["t"]].assign(a=1.0), "swerve").refusal.endswith("as one of a swerve")
