"""Bags as the recorders of ROS write them; the messages are packed by `rosbags`, not by what reads them here."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

START = 1_700_000_000_000_000_000
"""Time of the first message, ns: a date, as real clocks have."""

ROS2 = get_typestore(Stores.ROS2_HUMBLE)
ROS1 = get_typestore(Stores.ROS1_NOETIC)

Messages = Iterable[tuple[str, str, float, Any]]
"""Topic, type, time in s since `START`, message."""


def message(store: Any, kind: str, **fields: Any) -> Any:
    """Return a message of a type, of which only some fields are set."""
    types = store.fielddefs[kind][1]
    return store.types[kind](
        **{name: fields.get(name, _empty(store, description)) for name, description in types}
    )


def header(store: Any, seconds: float) -> Any:
    """Return a header whose stamp is so many seconds after `START`."""
    total = START + round(seconds * 1e9)
    time = store.types["builtin_interfaces/msg/Time"](sec=total // 10**9, nanosec=total % 10**9)
    return message(store, "std_msgs/msg/Header", stamp=time, frame_id="base")


def joint_state(store: Any, seconds: float, joints: Mapping[str, tuple[float, float, float]]) -> Any:
    """Return position, velocity and effort of some joints, in their order."""
    position, velocity, effort = np.array(list(joints.values()), dtype=float).T.copy()
    return message(
        store,
        "sensor_msgs/msg/JointState",
        header=header(store, seconds),
        name=list(joints),
        position=position,
        velocity=velocity,
        effort=effort,
    )


def write_ros2(folder: Path, messages: Messages, mcap: bool = False, store: Any = ROS2) -> Path:
    """Write a bag of ROS 2."""
    plugin = StoragePlugin.MCAP if mcap else StoragePlugin.SQLITE3
    with Writer2(folder, version=9, storage_plugin=plugin) as writer:
        connections: dict[str, Any] = {}
        for topic, kind, seconds, content in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            data = store.serialize_cdr(content, kind)
            writer.write(connections[topic], START + round(seconds * 1e9), data)
    return folder


def write_ros1(path: Path, messages: Messages) -> Path:
    """Write a bag of ROS 1."""
    with Writer1(path) as writer:
        connections: dict[str, Any] = {}
        for topic, kind, seconds, content in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ROS1)
            data = ROS1.serialize_ros1(content, kind)
            writer.write(connections[topic], START + round(seconds * 1e9), data)
    return path


def write_json(path: Path, messages: Iterable[tuple[str, float, Any]], compressed: bool = False) -> Path:
    """Write MCAP with messages in JSON: topic, time in s, content."""
    with path.open("wb") as file:
        writer = McapWriter(file, compression=CompressionType.ZSTD if compressed else CompressionType.NONE)
        writer.start()
        schema = writer.register_schema("State", "jsonschema", b"{}")
        channels: dict[str, int] = {}
        for topic, seconds, content in messages:
            if topic not in channels:
                channels[topic] = writer.register_channel(topic, "json", schema)
            time = START + round(seconds * 1e9)
            writer.add_message(channels[topic], time, json.dumps(content).encode(), time)
        writer.finish()
    return path


def _empty(store: Any, description: Any) -> Any:
    node, rest = description
    if node == 2:
        return message(store, rest)
    if node == 1:
        return {"string": "", "bool": False}.get(rest[0], 0)
    (inner, kind), count = rest
    if inner == 1 and kind[0] != "string":
        return np.zeros(
            count if node == 3 else 0, dtype={"byte": "u1", "char": "u1", "bool": "?"}.get(kind[0], kind[0])
        )
    return [""] * count if node == 3 and inner == 1 else []
