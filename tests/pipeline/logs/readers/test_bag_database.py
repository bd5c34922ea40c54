"""Databases of ROS 2 bags: the topics that `rosbags` finds, and all messages by time."""

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import Reader

from simgap.logs.readers.bag import read
from simgap.logs.readers.bag_database import messages_of, opened, topics_of
from tests.pipeline.logs.bag_writer import ROS2, write_ros2
from tests.pipeline.logs.test_bag import swinging

BAGS = ["ros2_kuka_med7_still", "ros2_odrive_idle"]


@pytest.fixture
def written(tmp_path: Path) -> Path:
    return write_ros2(tmp_path / "bag", swinging(ROS2)) / "bag.db3"


def assert_as_rosbags_says(path: Path) -> None:
    with Reader(path) as reader, closing(opened(path)) as database:
        found = list(topics_of(database))
        assert found == [
            (entry.id, entry.topic, entry.msgtype, entry.msgdef.data, entry.msgdef.format.name)
            for entry in reader.connections
        ]
        parts = list(messages_of(database, at_once=7))
        names = {topic.number: topic.name for topic in found}
        told = [
            (names[number], time, part.message(row))
            for which, times, part in parts
            for row, (number, time) in enumerate(zip(which.tolist(), times.tolist(), strict=True))
        ]
        assert [time for _, time, _ in told] == sorted(time for _, time, _ in told)
        expected = [(entry.topic, time, bytes(data)) for entry, time, data in reader.messages()]
        assert sorted(told) == sorted(expected)


def test_topics_and_messages_are_those_of_rosbags(written: Path) -> None:
    assert_as_rosbags_says(written)


@pytest.mark.parametrize("bag", BAGS)
def test_real_topics_and_messages_are_those_of_rosbags(shared_data: Path, bag: str) -> None:
    (path,) = (shared_data / "raw" / bag).glob("*/*.db3")
    assert_as_rosbags_says(path)


def test_bags_from_before_iron_hold_no_definitions(written: Path) -> None:
    import sqlite3

    before = read(written)
    with closing(sqlite3.connect(written)) as connection:
        connection.executescript("DROP TABLE message_definitions; DROP TABLE schema;")
    assert_as_rosbags_says(written)
    log = read(written)
    assert list(log.signals) == list(before.signals)
    for name, signal in log.signals.items():
        np.testing.assert_array_equal(signal.values, before.signals[name].values)
