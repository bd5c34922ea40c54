from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.formats import format_of, read_log
from simgap.logs.readers.bag import read
from tests.pipeline.logs.bag_writer import (
    ROS1,
    ROS2,
    header,
    joint_state,
    message,
    write_json,
    write_ros1,
    write_ros2,
)
from tests.pipeline.logs.damage import assert_a_log_or_one_line, damaged

JOINTS = "sensor_msgs/msg/JointState"
TIMES = np.arange(20) / 10


def swinging(store: Any, delay: float = 0.002) -> list[tuple[str, str, float, Any]]:
    """Two joints, of which the order changes from message to message."""
    found = []
    for number, t in enumerate(TIMES):
        joints = {"elbow": (np.sin(t), np.cos(t), 2 * t), "wrist": (0.5, 0.0, -1.0)}
        names = ["elbow", "wrist"] if number % 3 else ["wrist", "elbow"]
        state = joint_state(store, t, {name: joints[name] for name in names})
        found.append(("/joint_states", JOINTS, t + delay, state))
    return found


@pytest.mark.parametrize("kind", ["ros1", "db3", "mcap", "file"])
def test_joints_are_matched_by_name_in_every_container(tmp_path: Path, kind: str) -> None:
    if kind == "ros1":
        path = write_ros1(tmp_path / "a.bag", swinging(ROS1))
    else:
        path = write_ros2(tmp_path / "bag", swinging(ROS2), mcap=kind == "mcap")
    log = read_log(path / "bag.db3" if kind == "file" else path)
    np.testing.assert_array_equal(log.signals["/joint_states/position[elbow]"].values, np.sin(TIMES))
    np.testing.assert_array_equal(log.signals["/joint_states/effort[elbow]"].values, 2 * TIMES)
    np.testing.assert_array_equal(log.signals["/joint_states/velocity[wrist]"].values, 0.0)
    time = log.signals["/joint_states/position[wrist]"].time
    np.testing.assert_allclose(np.diff(time), 0.1, atol=1e-8)
    assert time[0] == pytest.approx(-0.002)  # the stamp, not the time of recording
    assert log.facts["/joint_states"] == JOINTS


def test_an_mcap_file_alone_is_read(tmp_path: Path) -> None:
    folder = write_ros2(tmp_path / "bag", swinging(ROS2), mcap=True)
    log = read_log(folder / "bag.mcap")
    np.testing.assert_array_equal(log.signals["/joint_states/position[elbow]"].values, np.sin(TIMES))


def test_stamps_of_another_clock_are_not_taken(tmp_path: Path) -> None:
    log = read(write_ros2(tmp_path / "bag", swinging(ROS2, delay=1000.0)))
    assert log.signals["/joint_states/position[elbow]"].time[0] == 0.0
    assert any("another clock" in remark for remark in log.remarks)


def test_nested_fields_arrays_and_padding(tmp_path: Path) -> None:
    imu = "sensor_msgs/msg/Imu"
    vector = ROS2.types["geometry_msgs/msg/Vector3"](x=1.0, y=2.0, z=3.0)
    texts = ["", "a", "base", "a longer frame"]  # each moves what follows to another place
    imus = []
    for t, text in enumerate(texts):
        content = message(ROS2, imu, header=header(ROS2, t), angular_velocity=vector)
        content.header.frame_id = text
        imus.append(("/imu", imu, float(t), content))
    multi = "std_msgs/msg/Float32MultiArray"
    array = message(ROS2, multi, data=np.array([1.5, 2.5], dtype="f4"))
    log = read(write_ros2(tmp_path / "bag", [*imus, ("/array", multi, 4.0, array)]))
    for axis, value in zip("xyz", (1.0, 2.0, 3.0), strict=True):
        np.testing.assert_array_equal(log.signals[f"/imu/angular_velocity/{axis}"].values, [value] * 4)
    assert not any("covariance" in name for name in log.signals)
    assert log.signals["/array/data[1]"].values.tolist() == [2.5]


def test_transforms_are_named_by_their_frames(tmp_path: Path) -> None:
    kind = "tf2_msgs/msg/TFMessage"

    def transforms(*frames: str) -> Any:
        entries = [
            message(ROS2, "geometry_msgs/msg/TransformStamped", child_frame_id=frame) for frame in frames
        ]
        for number, entry in enumerate(entries):
            entry.transform.translation.x = float(len(frames[number]))
        return message(ROS2, kind, transforms=entries)

    bag = [("/tf", kind, 0.0, transforms("a", "bcd")), ("/tf", kind, 1.0, transforms("bcd", "a"))]
    log = read(write_ros2(tmp_path / "bag", bag))
    assert log.signals["/tf/transforms[bcd]/transform/translation/x"].values.tolist() == [3.0, 3.0]


def test_long_arrays_are_left_out_and_told(tmp_path: Path) -> None:
    kind = "sensor_msgs/msg/Image"
    image = message(
        ROS2, kind, header=header(ROS2, 0.0), height=30, width=40, data=np.zeros(3600, dtype="u1")
    )
    log = read(write_ros2(tmp_path / "bag", [("/camera", kind, 0.0, image)]))
    assert log.signals["/camera/height"].values.tolist() == [30.0]
    assert "/camera: long arrays are left out: data." in log.remarks


def test_messages_without_a_definition_are_told(tmp_path: Path) -> None:
    import sqlite3

    path = write_ros2(tmp_path / "bag", swinging(ROS2)) / "bag.db3"
    with sqlite3.connect(path) as connection:
        connection.execute("DELETE FROM message_definitions")
        connection.execute("UPDATE topics SET type = 'my_msgs/msg/Status'")
    connection.close()
    log = read(path)
    assert not log.signals
    assert "my_msgs/msg/Status has no definition" in log.remarks[0]


@pytest.mark.parametrize("compressed", [False, True])
def test_time_that_goes_back_begins_a_run(tmp_path: Path, compressed: bool) -> None:
    episodes = [("/state", t, {"angle": t, "stamp": t}) for _ in range(3) for t in TIMES.tolist()]
    log = read(write_json(tmp_path / "a.mcap", episodes, compressed))
    signal = log.signals["/state/angle"]
    assert (np.diff(signal.time) > 0).all()
    assert len(log.spans) == 3
    for span in log.spans:
        inside = (signal.time >= span.begin) & (signal.time <= span.end)
        np.testing.assert_array_equal(signal.values[inside], TIMES)
    assert "goes back 2 times" in " ".join(log.remarks)


def test_json_joints_are_matched_by_name(tmp_path: Path) -> None:
    messages = [
        ("/joints", 0.0, {"name": ["a", "b"], "position": [1, 2], "ok": True, "nested": {"x": 7}}),
        ("/joints", 1.0, {"name": ["b", "a"], "position": [3, 4], "text": "no number"}),
    ]
    log = read(write_json(tmp_path / "a.mcap", messages))
    assert log.signals["/joints/position[a]"].values.tolist() == [1.0, 4.0]
    assert log.signals["/joints/nested/x"].time.tolist() == [0.0]


def test_a_file_that_was_cut_off_has_what_is_there(tmp_path: Path) -> None:
    path = write_json(tmp_path / "a.mcap", [("/state", t, {"x": t}) for t in TIMES.tolist()])
    cut = path.read_bytes()
    path.write_bytes(cut[: cut.index(b'{"x": 1.9}') + 200])  # within what follows the messages
    log = read(path)
    assert len(log.signals["/state/x"].values) == len(TIMES)
    assert any("cut off" in remark for remark in log.remarks)


def test_an_empty_folder_and_a_bag_without_messages_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no known format"):
        format_of(tmp_path)
    with pytest.raises(InputError, match="holds no messages"):
        read(write_json(tmp_path / "a.mcap", []))


@pytest.fixture(scope="module")
def contents(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("bags")
    few = slice(0, 4)
    json = write_json(folder / "a.mcap", [("/s", t, {"x": [t, 1]}) for t in TIMES[few].tolist()])
    return {
        ".bag": write_ros1(folder / "a.bag", swinging(ROS1)[few]).read_bytes(),
        ".db3": (write_ros2(folder / "db3", swinging(ROS2)[few]) / "db3.db3").read_bytes(),
        ".mcap": (write_ros2(folder / "cdr", swinging(ROS2)[few], mcap=True) / "cdr.mcap").read_bytes(),
        ".json.mcap": json.read_bytes(),
    }


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap", ".json.mcap"])
@settings(max_examples=15)
@given(data=st.data())
def test_damage_gives_a_log_or_one_line(
    tmp_path_factory: pytest.TempPathFactory, contents: dict[str, bytes], suffix: str, data: st.DataObject
) -> None:
    content = data.draw(damaged(contents[suffix]))
    if content:
        path = tmp_path_factory.getbasetemp() / f"damaged{suffix}"
        assert_a_log_or_one_line(read, path, content)


@pytest.mark.slow  # type checks at every call would take ten times as long
def test_real_bags(shared_data: Path) -> None:
    raw = shared_data / "raw"
    cartpole = read(raw / "mcap_cartpole_SIM/kinda_works.mcap")
    assert len(cartpole.spans) == 58  # 57 resets
    kuka = read(next(raw.glob("ros2_kuka_med7_still/*/*.db3")))
    assert kuka.signals["/joint_states/effort[lbr_joint_1]"].values.mean() == pytest.approx(58.8, abs=0.1)
    panda = read(raw / "ros1_panda_still/joint_states.bag")
    assert panda.signals["/joint_states/effort[panda_joint4]"].values.mean() == pytest.approx(18.4, abs=0.1)
