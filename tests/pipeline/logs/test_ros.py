from pathlib import Path
from typing import Any

import numpy as np
import pytest

from simgap.logs.apply import recording_of
from simgap.logs.formats import read_log
from simgap.logs.layouts.ros import propose
from tests.pipeline.logs.bag_writer import ROS2, header, joint_state, message, write_json, write_ros2
from tests.pipeline.logs.vehicle import assert_one_motion, flight

JOINTS = "sensor_msgs/msg/JointState"
ODOMETRY, IMU, MOTORS = "nav_msgs/msg/Odometry", "sensor_msgs/msg/Imu", "sensor_msgs/msg/Joy"
ACTUATORS = """
std_msgs/Header header
float64[] position
float64[] velocity
float64[] normalized
"""


def arm(folder: Path, moves: float) -> Path:
    messages = []
    for t in np.arange(50) / 50:
        joints = {
            "shoulder": (0.1 * moves * np.sin(t), 0.0, 1.0),
            "elbow": (moves * np.sin(6 * t), 6 * moves * np.cos(6 * t), np.sin(t)),
            "finger_joint": (2 * moves * t, 0.0, 0.0),
        }
        messages.append(("/joint_states", JOINTS, float(t), joint_state(ROS2, t, joints)))
    return write_ros2(folder / "bag", messages)


def test_the_joint_that_moves_most_is_proposed(tmp_path: Path) -> None:
    log = read_log(arm(tmp_path, 1.0))
    proposal = propose(log)
    assert proposal is not None
    assert proposal.is_sure
    assert {name: entry.source.signal for name, entry in proposal.columns.items()} == {
        name: f"/joint_states/{name}[elbow]" for name in ("position", "velocity", "effort")
    }
    assert "shoulder" in " ".join(proposal.notes)
    assert "finger" not in " ".join(proposal.notes)  # its unit is not told
    frame = recording_of(log, proposal.mapping()).frame
    np.testing.assert_allclose(frame["position"], np.sin(6 * frame["t"]), atol=1e-6)


def test_joints_that_do_not_move_are_refused(tmp_path: Path) -> None:
    proposal = propose(read_log(arm(tmp_path, 0.001)))
    assert proposal is not None
    assert "moves by more than" in proposal.refusal
    assert "record while" in proposal.refusal


def test_a_constant_effort_is_none(tmp_path: Path) -> None:
    messages = [
        ("/joint_states", JOINTS, t, joint_state(ROS2, t, {"a": (t, 1.0, 0.0)})) for t in np.arange(20) / 10
    ]
    proposal = propose(read_log(write_ros2(tmp_path / "bag", messages)))
    assert proposal is not None
    assert "effort" not in proposal.columns
    assert "/joint_states" in proposal.missing["effort"]


def flying(folder: Path, motors: bool = True) -> Path:
    """The flight of the racer, as MAVROS and a simulator publish it."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(ACTUATORS, "actuator_msgs/msg/Actuators"))
    frame = flight()
    messages: list[tuple[str, str, float, Any]] = []
    for row in frame.to_dict("records"):
        t = row["t"]
        stamp = header(store, t)
        quaternion = store.types["geometry_msgs/msg/Quaternion"](**{a: row[f"attitude_{a}"] for a in "xyzw"})
        odometry = message(store, ODOMETRY, header=stamp)
        odometry.pose.pose.orientation = quaternion
        odometry.pose.pose.position = _vector(store, "Point", [row[f"position_{axis}"] for axis in "xyz"])
        odometry.twist.twist.linear = _vector(store, "Vector3", _in_body(row))
        imu = message(
            store,
            IMU,
            header=stamp,
            angular_velocity=_vector(store, "Vector3", [row[f"body_rate_{axis}"] for axis in "xyz"]),
            linear_acceleration=_vector(store, "Vector3", [row[f"specific_force_{axis}"] for axis in "xyz"]),
        )
        messages += [("/odom", ODOMETRY, t, odometry), ("/imu", IMU, t, imu)]
        if motors:
            speeds = np.array([row[f"motor_speed_{rotor}"] for rotor in range(1, 5)])
            kind = "actuator_msgs/msg/Actuators"
            messages.append(("/motors", kind, t, message(store, kind, header=stamp, velocity=speeds)))
    return write_ros2(folder / "bag", messages, mcap=True, store=store)


def _vector(store: Any, kind: str, values: Any) -> Any:
    x, y, z = (float(value) for value in values)
    return store.types[f"geometry_msgs/msg/{kind}"](x=x, y=y, z=z)


def _in_body(row: dict[str, float]) -> np.ndarray:
    """Return the velocity in the frame of the body."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_quat([row[f"attitude_{axis}"] for axis in "xyzw"])
    return np.asarray(turn.inv().apply([row[f"velocity_{axis}"] for axis in "xyz"]))


def test_odometry_imu_and_motors_are_a_quadrotor(tmp_path: Path) -> None:
    log = read_log(flying(tmp_path))
    proposal = propose(log)
    assert proposal is not None
    assert proposal.kind == "quadrotor"
    assert not proposal.missing
    frame = recording_of(log, proposal.mapping()).frame
    assert_one_motion(frame)
    np.testing.assert_allclose(frame["motor_speed_3"], flight()["motor_speed_3"], rtol=1e-6)
    assert proposal.columns["motor_speed_1"].confidence < 0.9  # the order of the motors is not in a bag


def test_what_a_quadrotor_lacks_is_said(tmp_path: Path) -> None:
    proposal = propose(read_log(flying(tmp_path, motors=False)), "quadrotor")
    assert proposal is not None
    assert "/mavros/esc_status" in " ".join(proposal.missing.values())


def test_other_logs_are_left_to_others(tmp_path: Path) -> None:
    assert propose(read_log(write_json(tmp_path / "a.mcap", [("/s", 0.0, {"x": 1.0})]))) is None


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("ros2_kuka_med7_still/rosbag2_2023_02_01-11_21_54", "none of its 7 joints moves"),
        ("ros1_panda_still/joint_states.bag", "none of its 7 joints moves"),
        ("ros2_odrive_idle/rosbag2_2024_08_22-12_20_42", "odrive_can/msg/ControllerStatus has no definition"),
    ],
)
@pytest.mark.slow  # type checks at every call would take ten times as long
def test_real_bags_without_physics_are_refused(shared_data: Path, path: str, said: str) -> None:
    proposal = propose(read_log(shared_data / "raw" / path))
    assert proposal is not None
    assert said in proposal.refusal
