"""The contract of recordings: column names, units and required columns."""

from collections.abc import Iterable

KINDS = ("quadrotor", "swerve", "joint")


def _axes(name: str, unit: str, axes: str = "xyz") -> dict[str, str]:
    return {f"{name}_{axis}": unit for axis in axes}


def _four(name: str, unit: str) -> dict[str, str]:
    return _axes(name, unit, "1234")


QUADROTOR_STATE = (
    _axes("position", "m")
    | _axes("attitude", "1", "wxyz")
    | _axes("velocity", "m/s")
    | _axes("body_rate", "rad/s")
)
"""World frame x forward, y left, z up; attitude scalar-first, body to world; body rate in the body frame."""

_QUADROTOR = (
    QUADROTOR_STATE
    | _four("motor_speed", "rad/s")
    | _four("motor_command", "1")
    | {"battery_voltage": "V"}
    | _axes("specific_force", "m/s²")
    | {"thrust_command": "m/s²"}
    | _axes("body_rate_command", "rad/s")
    | {f"estimate_{column}": unit for column, unit in QUADROTOR_STATE.items()}
)

_SWERVE_REQUIRED = (
    _four("drive_voltage", "V")
    | _four("steer_voltage", "V")
    | _four("drive_velocity", "rad/s")
    | _four("steer_velocity", "rad/s")
    | _four("steer_angle", "rad")
)
_SWERVE = (
    _SWERVE_REQUIRED
    | _axes("chassis_velocity", "m/s", "xy")
    | {"chassis_rate": "rad/s", "battery_voltage": "V"}
    | _four("drive_current", "A")
    | _four("steer_current", "A")
)

_JOINT = {
    "position": "rad",
    "velocity": "rad/s",
    "effort": "N·m",
    "voltage": "V",
    "position_command": "rad",
    "current": "A",
    "battery_voltage": "V",
    "temperature": "°C",
}

COLUMNS: dict[str, dict[str, str]] = {"quadrotor": _QUADROTOR, "swerve": _SWERVE, "joint": _JOINT}
"""Every channel a kind may have, with its unit; for a sliding joint see `SLIDING_JOINT_UNITS`."""

SLIDING_JOINT_UNITS = {"position": "m", "velocity": "m/s", "effort": "N", "position_command": "m"}
"""Units of a joint whose position is measured in metres."""

REQUIRED: dict[str, tuple[str, ...]] = {
    "quadrotor": tuple(_axes("body_rate", "")),
    "swerve": tuple(_SWERVE_REQUIRED),
    "joint": ("position",),
}
"""Channels that every recording of a kind has."""

DERIVED_FROM: dict[str, dict[str, str]] = {"joint": {"velocity": "position"}}
"""Channels, by kind, that are derived from another one where a recording lacks them, and needed where it has them."""

TOGETHER: dict[str, tuple[str, ...]] = {
    "quadrotor": tuple(column for column in QUADROTOR_STATE if not column.startswith("body_rate")),
    "swerve": (),
    "joint": (),
}
"""Channels that a recording has all or none of: a flight controller often logs no position, velocity and attitude."""

ANY_OF: dict[str, tuple[tuple[str, ...], ...]] = {
    "quadrotor": (tuple(_four("motor_speed", "")), tuple(_four("motor_command", ""))),
    "swerve": (),
    "joint": (("effort",), ("voltage",), ("position_command",)),
}
"""Groups of channels of which a recording has at least one, whole."""

WHOLE_NUMBERS = ("segment", "filled")
"""What cleaning says of a sample: the unbroken stretch within the run, and 1 where an input of it was made up."""

INDEX_COLUMNS = ("run", "t", *WHOLE_NUMBERS)
"""What is no channel: the run, the time in s and, once cleaned, `WHOLE_NUMBERS`."""


def channel_units(kind: str, sliding: bool = False) -> dict[str, str]:
    """Return the unit of every channel of a kind.

    Args:
        kind: one of `KINDS`.
        sliding: whether a joint's position is in metres.
    """
    return COLUMNS[kind] | (SLIDING_JOINT_UNITS if sliding and kind == "joint" else {})


def required_channels(kind: str, columns: Iterable[str]) -> list[str]:
    """Return the channels that a recording with these columns must have.

    Those of `TOGETHER` count if it has one of them, those of `DERIVED_FROM` if they are there.
    """
    present = set(columns)
    together = TOGETHER[kind] if set(TOGETHER[kind]) & present else ()
    return [*together, *REQUIRED[kind], *(name for name in DERIVED_FROM.get(kind, {}) if name in present)]


def needed_channels(kind: str, columns: set[str]) -> list[str]:
    """Return `required_channels` and the channels of every any-of group that is whole in `columns`."""
    groups = [group for group in ANY_OF[kind] if set(group) <= columns]
    return [*required_channels(kind, columns), *(column for group in groups for column in group)]
