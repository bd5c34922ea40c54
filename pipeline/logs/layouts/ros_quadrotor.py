"""A quadrotor in a bag: odometry or the pose of MAVROS, IMU, and the commands or speeds of the motors.

REP 103 has x forward or east, y left or north, z up, and quaternions x, y, z, w: the contract's frames, so no signs.
"""

from collections.abc import Iterator

from simgap.logs.layouts.choices import Choice, choose, moves
from simgap.logs.layouts.rates import rated, told
from simgap.logs.layouts.ros_topics import has, topics_of
from simgap.logs.log import Log
from simgap.logs.proposal import Proposal, Proposed, lacking

_ODOMETRY = "nav_msgs/msg/Odometry"
_IMU = "sensor_msgs/msg/Imu"
_MOTORS = (
    "actuator_msgs/msg/Actuators",
    "mav_msgs/msg/Actuators",
    "mavros_msgs/msg/ESCStatus",
    "mavros_msgs/msg/RCOut",
)
_UNSURE = 0.8  # which of the four motors is which is not in the bag
_PULSE = 1000.0  # µs of a motor's pulse at rest, and from there to full speed

_HOW = "raise the rate of the topic to 100 Hz (of MAVROS: rosrun mavros mavcmd long 511 MESSAGE 10000)"
_ADVICE = {
    "position_x": "record the odometry: /mavros/local_position/odom, or another topic of nav_msgs/Odometry",
    "velocity_x": "record the odometry: /mavros/local_position/odom, or /mavros/local_position/velocity_local",
    "body_rate_x": "record the IMU: /mavros/imu/data, at 100 Hz or more",
    "motor_speed_1": (
        "record what the motors do: /mavros/esc_status, /mavros/rc/out, or a topic of actuator_msgs/Actuators"
    ),
}


def is_quadrotor(log: Log, kind: str | None) -> bool:
    """Whether a bag has motors as a quadrotor has or topics of MAVROS, or is said to be of one."""
    flies = any("/mavros/" in topic for topic in log.facts)
    return kind == "quadrotor" or flies or bool(topics_of(log, *_MOTORS))


def quadrotor_proposal(log: Log) -> Proposal:
    """Propose the columns of a quadrotor, and say what is missing.

    Args:
        log: of a bag.
    """
    columns: dict[str, Proposed] = {}
    for names, choices in (
        (_names("position", "xyz"), _positions(log)),
        (_names("attitude", "wxyz"), _attitudes(log)),
        (_names("velocity", "xyz"), _velocities(log)),
        (_names("body_rate", "xyz"), _imu(log, "angular_velocity", "rad/s")),
        (_names("specific_force", "xyz"), _imu(log, "linear_acceleration", "m/s²")),
        (_names("motor_speed", "1234"), _speeds(log)),
        (_names("motor_command", "1234"), _commands(log)),
        (["battery_voltage"], _voltage(log)),
    ):
        chosen = choose(log, choices)
        if chosen is not None:
            columns |= chosen.columns(names)
    motors = [entry.source.signal for name, entry in columns.items() if name.startswith("motor")]
    fast = rated(log, columns, _HOW)
    refusal = ""
    if motors and not moves(log, motors):
        refusal = "its motors never change; record a flight"
    elif fast.refused:
        refusal = f"is recorded too slowly to show physics: {told(fast.refused)}; {_HOW}"
    missing = {**_missing(dict(fast.columns)), **fast.missing}
    return Proposal("quadrotor", fast.columns, missing, notes=fast.notes, refusal=refusal)


def _names(name: str, axes: str) -> list[str]:
    return [f"{name}_{axis}" for axis in axes]


def _positions(log: Log) -> Iterator[Choice]:
    for topic, place in _poses(log):
        yield Choice([f"{topic}/{place}position/{axis}" for axis in "xyz"], f"position of {topic}", unit="m")


def _attitudes(log: Log) -> Iterator[Choice]:
    for topic, place in _poses(log):
        yield Choice([f"{topic}/{place}orientation/{axis}" for axis in "wxyz"], f"orientation of {topic}")
    for topic in topics_of(log, _IMU):
        yield Choice([f"{topic}/orientation/{axis}" for axis in "wxyz"], f"orientation of {topic}")


def _poses(log: Log) -> Iterator[tuple[str, str]]:
    """Yield topics that hold a pose, and where it is in their messages."""
    yield from ((topic, "pose/pose/") for topic in topics_of(log, _ODOMETRY))
    yield from (
        (topic, "pose/") for topic in topics_of(log, "geometry_msgs/msg/PoseStamped") if _measured(topic)
    )


def _measured(topic: str) -> bool:
    """Whether a topic by its name is no target."""
    return not any(part in topic.lower() for part in ("setpoint", "target", "goal", "reference", "command"))


def _velocities(log: Log) -> Iterator[Choice]:
    for topic in topics_of(log, "geometry_msgs/msg/TwistStamped"):
        if topic.endswith("velocity_local"):  # of MAVROS; its velocity_body is in the frame of the body
            signals = [f"{topic}/twist/linear/{axis}" for axis in "xyz"]
            yield Choice(signals, f"velocity of {topic}, along the world's axes", unit="m/s")
    for topic in topics_of(log, _ODOMETRY):
        signals = [f"{topic}/velocity_world/{axis}" for axis in "xyz"]
        yield Choice(signals, f"twist of {topic}, turned from the body to the world", unit="m/s")


def _imu(log: Log, field: str, unit: str) -> Iterator[Choice]:
    for topic in topics_of(log, _IMU):
        yield Choice([f"{topic}/{field}/{axis}" for axis in "xyz"], f"{field} of {topic}", unit=unit)


def _speeds(log: Log) -> Iterator[Choice]:
    order = "which motor is which is not in the bag"
    for topic in topics_of(log, "actuator_msgs/msg/Actuators", "mav_msgs/msg/Actuators"):
        for field in ("velocity", "angular_velocities"):
            signals = [f"{topic}/{field}[{rotor}]" for rotor in range(4)]
            if has(log, signals):
                yield Choice(
                    signals, f"speeds of {topic}; {order}", unit="rad/s", confidence=_UNSURE, held=True
                )
    for topic in topics_of(log, "mavros_msgs/msg/ESCStatus"):
        signals = [f"{topic}/esc_status[{rotor}]/rpm" for rotor in range(4)]
        yield Choice(signals, f"speeds of {topic}; {order}", unit="rpm", confidence=_UNSURE)


def _commands(log: Log) -> Iterator[Choice]:
    order = "which motor is which is not in the bag"
    for topic in topics_of(log, "actuator_msgs/msg/Actuators", "mav_msgs/msg/Actuators"):
        signals = [f"{topic}/normalized[{rotor}]" for rotor in range(4)]
        yield Choice(signals, f"commands of {topic}; {order}", confidence=_UNSURE, held=True)
    for topic in topics_of(log, "mavros_msgs/msg/RCOut"):
        signals = [f"{topic}/channels[{rotor}]" for rotor in range(4)]
        reason = f"pulses of {topic}, 1000 to 2000 µs; they may be a thrust (then root: true); {order}"
        yield Choice(
            signals,
            reason,
            confidence=_UNSURE,
            scales=[1 / _PULSE] * 4,
            offsets=[-1.0] * 4,
            held=True,
            unit="1",
        )


def _voltage(log: Log) -> Iterator[Choice]:
    for topic in topics_of(log, "sensor_msgs/msg/BatteryState"):
        yield Choice([f"{topic}/voltage"], f"voltage of {topic}", unit="V")


def _missing(columns: dict[str, Proposed]) -> dict[str, str]:
    """Return what is missing, the first column of each group for all of it."""
    return {
        name: _ADVICE[_group(name)] for name in lacking("quadrotor", set(columns)) if _group(name) in _ADVICE
    }


def _group(column: str) -> str:
    """Return the column under which the advice for a column stands."""
    name = column.rpartition("_")[0]
    return {"attitude": "position_x", "motor_speed": "motor_speed_1"}.get(name, f"{name}_x")
