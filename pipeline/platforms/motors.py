"""Motors by name: published figures, and what a platform makes of them."""

import difflib
import math
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from simgap.errors import InputError

TABLE = Path(__file__).with_name("motors.yaml")
_NEAR = 3  # names in an error; more do not fit into a line


@dataclass(frozen=True)
class NamedMotor:
    """The published figures of a motor, or of a servo at its output.

    Attributes:
        name: as its maker writes it.
        nominal_voltage: V.
        stall_torque: N·m at nominal voltage.
        stall_current: A at nominal voltage.
        free_speed_rpm: turns a minute at nominal voltage without load.
        source: where the figures are published.
        free_current: A without load; None where it is not published.
        gear_ratio: motor turns per turn of the servo's output; 1 for a motor, and where it is not published.
        also: other names.
    """

    name: str
    nominal_voltage: float
    stall_torque: float
    stall_current: float
    free_speed_rpm: float
    source: str
    free_current: float | None = None
    gear_ratio: float = 1.0
    also: tuple[str, ...] = ()

    @property
    def free_speed(self) -> float:
        """Without load at nominal voltage, rad/s."""
        return self.free_speed_rpm * 2.0 * math.pi / 60.0

    @property
    def resistance(self) -> float:
        """Of the winding: nominal voltage over stall current, Ω."""
        return self.nominal_voltage / self.stall_current

    @property
    def back_emf_constant(self) -> float:
        """Voltage per speed, V/(rad/s), less what the free current drops in the winding.

        It equals the torque constant of a motor without losses (Krishnan, "Electric Motor Drives", chapter 2). The
        friction that draws the free current, and the losses of a gear, are not in it.
        """
        left = self.nominal_voltage - self.resistance * (self.free_current or 0.0)
        return left / self.free_speed

    def of_joint(self, count: int = 1, gear_ratio: float = 1.0) -> dict[str, float]:
        """Return the keys of a `JointMotor`.

        Args:
            count: motors on one shaft, each with the whole voltage.
            gear_ratio: turns of the motor, or of the servo's output, per turn of the joint.
        """
        return {
            "resistance": self.resistance / count,
            "torque_constant": self.back_emf_constant / self.gear_ratio,
            "gear_ratio": self.gear_ratio * gear_ratio,
        }

    def of_axis(self, count: int = 1) -> dict[str, float]:
        """Return the keys of a `DirectCurrentMotor`: the published figures of `count` motors on one shaft."""
        return {
            "nominal_voltage": self.nominal_voltage,
            "free_speed": self.free_speed,
            "stall_torque": self.stall_torque * count,
            "stall_current": self.stall_current * count,
        }


@cache
def motors() -> tuple[NamedMotor, ...]:
    """Return all motors, in the order of the table."""
    from simgap.artifacts.plain_yaml import read_yaml

    table = read_yaml(TABLE)
    return tuple(_motor(str(name), dict(entry)) for name, entry in table.items())


def _motor(name: str, entry: dict[str, Any]) -> NamedMotor:
    texts: dict[str, Any] = {"source": entry.pop("source"), "also": tuple(entry.pop("also", ()))}
    figures: dict[str, Any] = {key: float(value) for key, value in entry.items()}
    return NamedMotor(name=name, **texts, **figures)


def motor_named(name: Any, where: str) -> NamedMotor:
    """Return a motor by its name; case, spaces and hyphens do not matter.

    Args:
        name: as a person writes it.
        where: the key to name in an error.

    Raises:
        InputError: when there is no such motor, with the nearest names.
    """
    known = _by_name()
    plain = _plain(name) if isinstance(name, str) else ""
    if plain in known:
        return known[plain]
    near = list(dict.fromkeys(known[key].name for key in _nearest(plain, known)))[:_NEAR]
    remedy = f"did you mean {' or '.join(map(repr, near))}?" if near else "see simgap motors"
    raise InputError(f"there is no motor {name!r}", where, remedy)


@cache
def _by_name() -> dict[str, NamedMotor]:
    return {_plain(each): motor for motor in motors() for each in (motor.name, *motor.also)}


def _nearest(plain: str, known: dict[str, NamedMotor]) -> list[str]:
    """Return names that begin alike, such as the voltages of one servo, else those that are spelt alike."""
    begin = sorted(key for key in known if len(plain) > 1 and key.startswith(plain))
    return begin or difflib.get_close_matches(plain, known, n=2 * _NEAR)


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.casefold())
