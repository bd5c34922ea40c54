"""Words in the names of FRC signals: which quantity of which motor, measured or wanted."""

import re
from dataclasses import dataclass
from functools import cache

from simgap.logs.log import Signal
from simgap.recordings.units import conversion

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_WANTED = {
    "desired",
    "target",
    "targets",
    "setpoint",
    "setpoints",
    "goal",
    "reference",
    "ref",
    "command",
    "commanded",
}
_NOT_OF_THE_MOTOR = {
    "supply",
    "bus",
    "battery",
    "input",
    "odometry",
    "unoptimized",
    "error",
    "feedforward",
    "ff",
}
_DUTY = {"percentage", "percent", "duty", "dutycycle"}
_DRIVE = {"drive", "driving", "wheel"}
_STEER = {"turn", "turning", "steer", "steering", "azimuth", "angle", "azmth"}
_DIMENSIONS = {
    "V": "voltage", "A": "current", "rad/s": "velocity", "m/s": "velocity", "rad": "position", "m": "position",
}  # fmt: skip
_QUANTITIES = {
    "voltage": {"volts", "voltage"},
    "current": {"amps", "current", "amperes"},
    "velocity": {"velocity", "speed", "rpm"},
    "position": {"position", "angle", "distance"},
}
_UNITS = {
    "rad",
    "radians",
    "deg",
    "degrees",
    "rot",
    "rotations",
    "rev",
    "per",
    "sec",
    "second",
    "min",
    "meters",
    "rads",
}


@dataclass(frozen=True)
class Words:
    """What the name and the unit of a signal say.

    Attributes:
        quantity: voltage, current, velocity, position, duty, or empty.
        group: drive, steer, or empty.
        wanted: whether it is a target, no measurement.
        of_motor: whether it is of the motor, not of its supply or of something computed.
        absolute: whether an absolute encoder measured it.
        stem: the name without what says quantity and unit; signals of one motor share it.
    """

    quantity: str
    group: str
    wanted: bool
    of_motor: bool
    absolute: bool
    stem: str


@cache
def words_in(text: str) -> tuple[str, ...]:
    """Return the words of a name in small letters: `DriveAppliedVolts` has drive, applied and volts."""
    return tuple(word.lower() for word in _WORD.findall(text))


def words_of(signal: Signal) -> Words:
    """Return what the name and the unit of a signal say of it."""
    name = signal.name.removesuffix("/value")
    parent, _, last = re.sub(r"\[\d+\]$", "", name).rpartition("/")
    own, all_words = words_in(last), set(words_in(name))
    quantity = _quantity(signal.unit, own)
    is_state = name.endswith("/speed") and signal.unit == "m/s"  # of a SwerveModuleState
    group = "drive" if is_state else _group(set(own)) or _group(all_words)
    spoken = {"motor", "applied", "absolute", "stator", "torque", "rotor", "encoder", *_UNITS, *_DUTY}
    spoken |= {word for words in _QUANTITIES.values() for word in words} - {"angle"}
    stem = "/".join((parent, "".join(word for word in own if word not in spoken)))
    return Words(
        quantity,
        group,
        wanted=bool(all_words & _WANTED),
        of_motor=not set(own) & _NOT_OF_THE_MOTOR,
        absolute="absolute" in own,
        stem=stem,
    )


def _quantity(unit: str | None, own: tuple[str, ...]) -> str:
    """Return the quantity by the unit, else by the last word that names one."""
    if set(own) & _DUTY:
        return "duty"
    found = conversion(unit) if unit else None
    if found is not None and found[0] in _DIMENSIONS:
        return _DIMENSIONS[found[0]]
    spoken = (quantity for word in reversed(own) for quantity, words in _QUANTITIES.items() if word in words)
    return next(spoken, "")


def _group(words: set[str]) -> str:
    return "steer" if words & _STEER else "drive" if words & _DRIVE else ""
