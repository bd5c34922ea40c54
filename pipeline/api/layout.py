"""What the entries of a machine's state and command are called, by kind; the names are those of a recording."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from torch import Tensor

from simgap.errors import InputError
from simgap.platforms import Joint, Platform
from simgap.recordings.contract import QUADROTOR_STATE, channel_units
from simgap.simulation.motion import motion_of

_FOUR = ("1", "2", "3", "4")
_STATE = {
    "quadrotor": tuple(QUADROTOR_STATE),
    "joint": ("position", "velocity"),
    "swerve": (
        *("chassis_velocity_x", "chassis_velocity_y", "chassis_rate"),
        *(f"steer_angle_{module}" for module in _FOUR),
        *(f"steer_velocity_{module}" for module in _FOUR),
        "heading",
    ),
}
_NOT_RECORDED = {"heading": "rad"}
_SIGNALS = {
    "motor_command": {"motor_command": 4},
    "motor_speed": {"rotor_speed": 4},
    "voltage": {"voltage": 1},
    "effort": {"effort": 1},
    "position_command": {"position_command": 1},
    "voltages": {"drive_voltage": 4, "steer_voltage": 4},
}
_CHOICES = {
    "quadrotor": ("motor_command", "motor_speed"),
    "joint": ("voltage", "effort", "position_command"),
    "swerve": ("voltages",),
}


@dataclass(frozen=True)
class Layout:
    """The entries of state and command.

    Attributes:
        state: names of the state's entries.
        command: names of the command's entries.
        units: of each of them.
        signals: how many entries of the command, from the first on, each signal of the simulation has.
    """

    state: tuple[str, ...]
    command: tuple[str, ...]
    units: Mapping[str, str]
    signals: Mapping[str, int]

    def parted(self, commands: Tensor) -> dict[str, Tensor]:
        """Return the signals of the simulation, (..., ·) or (...,), that commands (..., m) are."""
        parts = commands.split(list(self.signals.values()), dim=-1)
        named = zip(self.signals.items(), parts, strict=True)
        return {name: part if width > 1 else part[..., 0] for (name, width), part in named}


def layout_of(platform: Platform, command: str | None, position_unit: str) -> Layout:
    """Return the entries of a platform's state and command.

    Args:
        platform: of any kind.
        command: by what the machine is driven: `motor_command` or `motor_speed` of a quadrotor, `voltage`,
            `position_command` or `effort` of a joint, `voltages` of a swerve drive; None takes the first one that the
            platform can be driven by.
        position_unit: of a joint, rad or m.

    Raises:
        InputError: when the platform cannot be driven so.
    """
    possible = _CHOICES[platform.kind]
    if isinstance(platform, Joint):
        possible = _ways_of(platform, command)
    chosen = possible[0] if command is None else command
    if chosen not in possible:
        remedy = f"use {' or '.join(map(repr, possible))}"
        raise InputError(f"a {platform.kind} is not driven by {chosen!r}", "command", remedy)
    signals = _SIGNALS[chosen]
    names = tuple(name for signal, width in signals.items() for name in _columns(signal, chosen, width))
    state = _STATE[platform.kind]
    assert len(state) == max(part.stop for part in motion_of(platform).parts.values())
    known = channel_units(platform.kind, position_unit == "m") | _NOT_RECORDED
    return Layout(state, names, {name: known[name] for name in (*state, *names)}, signals)


def _ways_of(platform: Joint, command: str | None) -> tuple[str, ...]:
    """Return by what a joint can be driven, the usual way first; refuse a way for which a part is missing."""
    if platform.motor is None and command == "voltage":
        remedy = "give resistance, torque_constant and gear_ratio, or use command='effort'"
        raise InputError("is missing, so that a voltage drives nothing", "platform.motor", remedy)
    told = platform.controller is not None and not platform.controller.unknown
    if not told and command == "position_command":
        remedy = "give proportional and derivative, or use command='effort'"
        raise InputError("has no gains, so that a position drives nothing", "platform.controller", remedy)
    ways = {"voltage": platform.motor is not None, "position_command": told, "effort": True}
    return tuple(way for way, possible in ways.items() if possible)


def recorded_command(kind: str, signals: Iterable[str]) -> str | None:
    """Return by what a recorded machine was driven, as `layout_of` takes it; None where nothing of it was recorded.

    Args:
        kind: of the platform.
        signals: of the simulation, those that were recorded.
    """
    known = set(signals)
    return next((choice for choice in _CHOICES[kind] if _SIGNALS[choice].keys() <= known), None)


def _columns(signal: str, chosen: str, width: int) -> list[str]:
    """Return the columns of a recording that hold a signal."""
    stem = chosen if len(_SIGNALS[chosen]) == 1 else signal
    return [stem] if width == 1 else [f"{stem}_{number}" for number in _FOUR]
