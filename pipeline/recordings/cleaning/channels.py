"""Properties of channels: which are sent together, which are commands, which change slowly."""

from collections.abc import Iterable


def axes(name: str, suffixes: str = "xyz") -> list[str]:
    """Return the names of a vector's components."""
    return [f"{name}_{suffix}" for suffix in suffixes]


ATTITUDE = axes("attitude", "wxyz")
ESTIMATED_ATTITUDE = axes("estimate_attitude", "wxyz")
QUATERNIONS = (ATTITUDE, ESTIMATED_ATTITUDE)

MOTOR_SPEED = axes("motor_speed", "1234")
MOTOR_COMMAND = axes("motor_command", "1234")
SPECIFIC_FORCE = axes("specific_force")
POSITION = axes("position")
VELOCITY = axes("velocity")
BODY_RATE = axes("body_rate")

SLOW = frozenset({"battery_voltage", "temperature"})
"""Channels that are often logged at a lower rate."""

ANGLES = frozenset({*axes("steer_angle", "1234")})
"""Channels that may wrap from π to −π."""

_QUADROTOR_STATE = [*POSITION, *ATTITUDE, *VELOCITY, *BODY_RATE]

TELEGRAMS: dict[str, tuple[list[str], ...]] = {
    "quadrotor": (
        _QUADROTOR_STATE,
        MOTOR_SPEED,
        MOTOR_COMMAND,
        SPECIFIC_FORCE,
        [f"estimate_{column}" for column in _QUADROTOR_STATE],
    ),
    "swerve": (
        [*axes("drive_velocity", "1234"), *axes("steer_velocity", "1234"), *axes("steer_angle", "1234")],
        [*axes("chassis_velocity", "xy"), "chassis_rate"],
    ),
    "joint": (["position", "velocity"],),
}
"""Channels that travel in one message, and so are held together when one is lost. Voltages and efforts are
not among them: an input that stays the same is no lost message."""

RATES: dict[str, list[str]] = {
    "quadrotor": [
        *VELOCITY,
        *BODY_RATE,
        *MOTOR_SPEED,
        *(f"estimate_{name}" for name in (*VELOCITY, *BODY_RATE)),
    ],
    "swerve": [
        *axes("drive_velocity", "1234"),
        *axes("steer_velocity", "1234"),
        *axes("chassis_velocity", "xy"),
        "chassis_rate",
    ],
    "joint": ["velocity"],
}
"""Channels that are zero at rest."""

INPUTS: dict[str, list[str]] = {
    "quadrotor": [],
    "swerve": [*axes("drive_voltage", "1234"), *axes("steer_voltage", "1234")],
    "joint": ["effort", "voltage", "position_command"],
}
"""Inputs that a program holds until the next one: between two samples the earlier one is what acted. A
quadrotor's commands come from a feedback loop far faster than the log, so they are taken as continuous."""

COMMANDS = frozenset({*MOTOR_COMMAND, "thrust_command", *axes("body_rate_command")})
"""What a controller asks of a quadrotor: it may jump as it likes."""


def telegrams(kind: str, columns: Iterable[str]) -> list[list[str]]:
    """Return the groups of recorded channels that arrive in one message."""
    present = set(columns)
    groups = [[column for column in group if column in present] for group in TELEGRAMS[kind]]
    return [group for group in groups if group]


def vectors(columns: Iterable[str]) -> list[list[str]]:
    """Return channels grouped into vectors by their common name."""
    groups: dict[str, list[str]] = {}
    for column in columns:
        stem, _, suffix = column.rpartition("_")
        groups.setdefault(stem if suffix in tuple("wxyz1234") else column, []).append(column)
    return list(groups.values())
