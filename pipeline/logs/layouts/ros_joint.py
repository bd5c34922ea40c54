"""The joint of a bag that moves most: sensor_msgs/JointState, and the target that a controller publishes."""

from collections.abc import Sequence

import numpy as np

from simgap.logs.layouts.ros_topics import has, topics_of
from simgap.logs.log import Log
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed
from simgap.recordings.contract import COLUMNS

_STILL = 0.01  # rad (or m); ten steps of a usual encoder of 4096 counts, and less than any motion worth a diagnosis
_SLIDING = (
    "finger",
    "gripper",
    "prismatic",
    "slide",
    "rail",
)  # parts of names of joints whose unit is not told
_TARGETS = {  # type to the field of the target
    "control_msgs/msg/JointTrajectoryControllerState": ("reference/positions", "desired/positions"),
}
_RECORD = "ros2 bag record -s mcap /joint_states /joint_trajectory_controller/controller_state"


def joint_proposal(log: Log, topics: Sequence[str]) -> Proposal:
    """Propose the columns of the joint that moves most.

    Args:
        log: of a bag.
        topics: of type sensor_msgs/JointState.
    """
    motion = _motion(log, topics)
    moving = [joint for joint in sorted(motion, key=lambda name: -motion[name]) if motion[joint] > _STILL]
    if not motion:
        return Proposal(
            "joint", {}, refusal="its joint states hold no positions; publish position in /joint_states"
        )
    if not moving:
        largest = max(motion.values())
        refusal = (
            f"none of its {len(motion)} joints moves by more than {largest:.2g} rad; record while one joint moves to "
            "and fro"
        )
        return Proposal("joint", {}, refusal=refusal)
    topic, name = moving[0]
    columns = _columns(log, topic, name)
    return Proposal("joint", columns, _missing(columns, name), notes=tuple(_notes(moving, motion)))


def _motion(log: Log, topics: Sequence[str]) -> dict[tuple[str, str], float]:
    """Return how far each joint moves: (topic, joint) to rad."""
    found = {}
    for topic in topics:
        head = f"{topic}/position["
        for name, signal in log.signals.items():
            values = signal.values[np.isfinite(signal.values)]
            joint = name[len(head) : -1]
            if name.startswith(head) and len(values) and not any(part in joint.lower() for part in _SLIDING):
                found[topic, joint] = float(np.ptp(values))
    return found


def _columns(log: Log, topic: str, joint: str) -> dict[str, Proposed]:
    columns = {}
    for column, unit in (("position", "rad"), ("velocity", "rad/s"), ("effort", "N·m")):
        name = f"{topic}/{column}[{joint}]"
        if has(log, [name]) and (column == "position" or np.ptp(_known(log, name)) > 0):
            reason = f"{column} of the joint that moves most, by sensor_msgs/JointState in {unit}"
            confidence = 0.9 if column == "effort" else 1.0  # some drivers publish a current as effort
            columns[column] = Proposed(Source(name, unit=unit), confidence, reason)
    target = _target(log, joint)
    if target is not None and "position_command" in COLUMNS["joint"]:
        columns["position_command"] = Proposed(
            Source(target, unit="rad", held=True), 1.0, "the target of the controller of this joint"
        )
    return columns


def _target(log: Log, joint: str) -> str | None:
    for kind, fields in _TARGETS.items():
        for topic in topics_of(log, kind):
            for field in fields:
                if has(log, [f"{topic}/{field}[{joint}]"]):
                    return f"{topic}/{field}[{joint}]"
    return None


def _known(log: Log, name: str) -> np.ndarray:
    values = log.signals[name].values
    return values[np.isfinite(values)]


def _missing(columns: dict[str, Proposed], joint: str) -> dict[str, str]:
    missing = {}
    if "velocity" not in columns:
        missing["velocity"] = f"publish the velocity of {joint} in /joint_states"
    if "effort" not in columns and "position_command" not in columns:
        missing["effort"] = (
            f"{joint} has no effort that changes; publish it in N·m in /joint_states, or record the target, too: "
            f"{_RECORD}"
        )
    return missing


def _notes(moving: Sequence[tuple[str, str]], motion: dict[tuple[str, str], float]) -> list[str]:
    first, *others = moving
    notes = [f"The joint {first[1]} moves most, by {motion[first]:.3g} rad."]
    if others:
        listed = ", ".join(f"{joint} ({motion[topic, joint]:.2g} rad)" for topic, joint in others[:10])
        notes.append(f"Other joints that move: {listed}. To diagnose one, name it in the mapping.")
    return notes
