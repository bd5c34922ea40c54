"""Published tables as a stranger would bring them: what is proposed, what is refused, and with which words."""

from pathlib import Path

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.logs.formats import read_log
from simgap.logs.opening import open_recording
from simgap.logs.proposal import SURE, Proposal, propose
from simgap.recordings.importers import importer

ARM = "raw/openarm_joint_friction/real_uart_capture_collect_joint_7.npz"
FLYWHEEL = "flywheel/Flywheel characterization.csv"


def at_hand(shared_data: Path, name: str) -> Path:
    path = shared_data / name
    if not path.exists():
        pytest.skip(f"{name} is not here")
    return path


def proposed(shared_data: Path, name: str) -> Proposal:
    return propose(read_log(at_hand(shared_data, name)))


def sources(proposal: Proposal, *columns: str) -> list[str]:
    return [proposal.columns[column].source.signal for column in columns]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        (
            "raw/stm32_gearmotor_step/step_response.csv",
            "'setpoint_rpm' is a target: log the controller's output",
        ),
        ("raw/rmd_motor/dc_motor/Identification_traj_3.csv", "'Current .units.' is a current: give effort"),
        ("raw/ros2_odrive_idle/controller1.csv", "nothing moves: 'pos_estimate' stays within"),
        ("raw/ros2_odrive_idle/controller2.csv", "nothing moves: 'pos_estimate' stays within"),
        ("arm_so101/velocity_ramp/event.csv", "no signal is known"),
    ],
)
def test_what_cannot_be_diagnosed_says_why(shared_data: Path, name: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        open_recording(at_hand(shared_data, name), "joint")
    assert "\n" not in str(caught.value)


def test_a_gear_motor_without_its_duty(shared_data: Path) -> None:
    proposal = proposed(shared_data, "raw/stm32_gearmotor_step/step_response.csv")
    assert sources(proposal, "t", "velocity") == ["timestamp_ms", "actual_rpm"]
    assert set(proposal.missing) == {"effort"}


def test_a_motor_with_a_raw_current(shared_data: Path) -> None:
    proposal = proposed(shared_data, "raw/rmd_motor/dc_motor/Identification_traj_1.csv")
    assert sources(proposal, "t", "position", "velocity") == ["Time (sec)", "Angle (rad)", "Speed (rad/sec)"]
    assert all(found.confidence >= SURE for found in proposal.columns.values())


def test_a_servo_without_time_stamps(shared_data: Path) -> None:
    proposal = proposed(shared_data, "raw/hobby_servo_miuzei/dataset.json")
    assert sources(proposal, "run", "position") == ["run", "sensor_data"]
    assert "config.action_hz = 50" in proposal.missing["t"]


def test_an_arm_whose_speed_is_scaled(shared_data: Path) -> None:
    """Joint 7 moves alone; its speed is 1.6 times too small, which no unit explains: a person has to say it."""
    proposal = proposed(shared_data, ARM)
    assert sources(proposal, "t", "position", "velocity", "effort") == [
        "time",
        "q[6]",
        "qd[6]",
        "tau_measured[6]",
    ]
    assert not proposal.is_sure
    assert "1.611 times the integral" in proposal.columns["velocity"].reason


def test_the_proposal_of_an_arm_is_written_and_can_be_given_back(
    shared_data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = at_hand(shared_data, ARM)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="mapping="):
        open_recording(path, "joint")
    recording = open_recording(path, "joint", next(tmp_path.glob("*.yaml")))
    assert len(recording.frame) == 1092
    speed, effort = (recording.frame[name].to_numpy() for name in ("velocity", "effort"))
    law = np.stack([np.sign(speed), speed], axis=1)[np.abs(speed) > 0.1]
    coulomb, viscous = np.linalg.lstsq(law, effort[np.abs(speed) > 0.1], rcond=None)[0]
    assert coulomb == pytest.approx(0.075, abs=0.02)  # what plain least squares gives on the published file
    assert viscous == pytest.approx(0.066, abs=0.02)


def test_a_flywheel_by_mapping_is_the_published_one(shared_data: Path, tmp_path: Path) -> None:
    path = at_hand(shared_data, FLYWHEEL)
    own = tmp_path / "flywheel.yaml"
    own.write_text(
        "kind: joint\nt: {from: Time (s)}\nvoltage: {from: Input voltage (V), held: true}\n"
        "velocity: {from: Angular velocity (rad/s)}\nposition: {from: Angular velocity (rad/s), integrate: true}\n"
    )
    options = {
        "kind": "joint",
        "columns": {"t": "Time (s)", "voltage": "Input voltage (V)", "velocity": "Angular velocity (rad/s)"},
        "integrate": {"position": "velocity"},
    }
    mapped, imported = open_recording(path, "joint", own), importer("table")([path], options)
    for column in ("velocity", "voltage", "position"):
        np.testing.assert_allclose(mapped.frame[column], imported.frame[column], atol=1e-6)
    np.testing.assert_allclose(
        mapped.frame["t"], imported.frame["t"] - imported.frame["t"].iloc[0], atol=1e-9
    )


def test_a_servo_whose_load_is_a_number_of_sixteen_bits(shared_data: Path) -> None:
    proposal = proposed(shared_data, "servo_xl330/raw/2026-01-15_10h28m10.json")
    assert sources(proposal, "t", "position", "velocity") == ["timestamp", "position", "speed"]
    assert not any(name == "effort" and found.confidence >= SURE for name, found in proposal.columns.items())


def test_flights_with_their_traps(shared_data: Path) -> None:
    """One has its accelerometer in the axes of the world; the other in g of the body."""
    trapped = proposed(shared_data, "nanodrone/raw_parquet/square_20251017_run1.parquet")
    assert trapped.kind == "quadrotor"
    assert "specific_force_x" not in trapped.columns
    assert any("axes of the world" in note for note in trapped.notes)
    whole = proposed(shared_data, "nanobench/B7_oval_fast_rep2.csv")
    assert sources(whole, "attitude_w", "body_rate_x", "specific_force_z") == ["qw", "wx_vicon", "imu_acc_z"]
    assert whole.columns["specific_force_z"].source.unit == "g"


def test_an_arm_of_lists_in_cells(shared_data: Path) -> None:
    proposal = proposed(shared_data, "arm_so101/velocity_ramp/state_motor.csv")
    assert proposal.kind == "joint"
    assert proposal.columns["t"].source.unit == "us"
    assert "6 joints move" in " ".join(proposal.notes)
