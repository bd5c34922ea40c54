"""Columns of ROS bags: the joint of an arm that moves most, or a quadrotor. All units and frames are REP 103's."""

from simgap.logs.layouts.ros_joint import joint_proposal
from simgap.logs.layouts.ros_quadrotor import is_quadrotor, quadrotor_proposal
from simgap.logs.layouts.ros_topics import topics_of
from simgap.logs.log import Log
from simgap.logs.proposal import Proposal

_JOINTS = "sensor_msgs/msg/JointState"


def propose(log: Log, kind: str | None = None) -> Proposal | None:
    """Propose the columns of a bag; None where it is of another format, or holds no messages of these types.

    Args:
        log: as it was read.
        kind: what it is a recording of, where that is known.
    """
    if log.format != "bag":
        return None
    if not log.signals:
        return Proposal(kind, {}, refusal=_nothing(log))
    if kind in (None, "quadrotor") and is_quadrotor(log, kind):
        return quadrotor_proposal(log)
    if kind in (None, "joint") and topics_of(log, _JOINTS):
        return joint_proposal(log, topics_of(log, _JOINTS))
    return None


def _nothing(log: Log) -> str:
    said = log.remarks[0] if log.remarks else "It holds no messages."
    return (
        f"no message of it can be read. {said} Record with ros2 bag record -s mcap, which keeps the definitions of "
        "the messages, on a machine where their package is installed"
    )
