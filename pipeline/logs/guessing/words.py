"""What the name of a signal says: which quantity, whether it is commanded, and of which part of the machine."""

import re
from dataclasses import dataclass

from simgap.logs.header_units import FOREIGN, quantity_words, unit_in
from simgap.recordings.units import conversion

_WORDS: dict[str, tuple[str, ...]] = {
    "battery": ("battery", "batt", "bat", "vbat", "vbatt", "supply", "vbus", "vcc", "vin", "vdd"),
    "temperature": ("temperature", "temp", "temps", "celsius", "temperatur"),
    "acceleration": (
        "acceleration", "accelerations", "accelerometer", "acc", "accel", "accl", "acceler", "ax", "ay", "az",
        "qdd", "ddq", "beschleunigung",
    ),
    "body_rate": ("gyro", "gyros", "gyr", "gyroscope", "bodyrate"),
    "velocity": (
        "velocity", "velocities", "vel", "speed", "speeds", "spd", "omega", "qd", "dq", "qdot", "rate", "rpm",
        "thetadot", "dtheta", "angvel", "posdot", "dpos", "drehzahl", "geschwindigkeit", "velo", "thetad",
    ),
    "duty": ("duty", "dutycycle", "pwm", "throttle", "percentoutput"),
    "voltage": ("voltage", "voltages", "volts", "volt", "u", "spannung"),
    "effort": ("effort", "efforts", "torque", "torques", "tau", "trq", "force", "load", "drehmoment"),
    "current": ("current", "currents", "curr", "cur", "amps", "ampere", "amperage", "iq", "strom"),
    "position": (
        "position", "positions", "pos", "angle", "angles", "ang", "theta", "q", "phi", "encoder", "enc",
        "rotation", "winkel", "posn",
    ),
}  # fmt: skip
"""Quantity to its names, in the order in which they decide where a name has several."""

_WEAK = {
    "load": 0.5,
    "rate": 0.6,
    "u": 0.7,
    "phi": 0.8,
    "enc": 0.8,
    "encoder": 0.8,
    "rotation": 0.8,
    "cur": 0.8,
}
COMMANDED = frozenset((
    "cmd", "command", "commanded", "commands", "target", "targets", "setpoint", "setpoints", "sp", "goal",
    "ref", "reference", "desired", "des", "action", "actions", "demand", "requested",
))  # fmt: skip
_OTHER = frozenset((
    "error", "err", "std", "stddev", "cov", "covariance", "variance", "min", "max", "limit", "lim",
    "integral", "ff", "feedforward", "jerk", "status", "flag",
    "flags", "mode", "count", "hz", "fps", "latency", "id", "kp", "kd", "ki", "gain",
    "bandwidth", "kbps", "transfer", "residual", "ee", "tcp", "tool", "pose", "cartesian", "quat",
    "quaternion",
))  # fmt: skip
_SAME = frozenset((
    "actual", "measured", "meas", "measurement", "present", "state", "states", "est", "estimate",
    "estimated", "feedback", "fb", "joint", "joints", "motor", "axis", "servo", "data", "value", "raw",
    "real", "sensor", "input", "output", "applied", "angular", "angle", "shaft", "bus", "the", "of", "in",
    "per", "is", "coil", "winding", "terminal", "armature", "mot",
))  # fmt: skip
_PREFERRED = frozenset(("actual", "measured", "meas", "measurement", "present"))
_DOT = frozenset(("dot", "d", "derivative"))
_OF_UNIT = {
    "V": "voltage",
    "N·m": "effort",
    "A": "current",
    "°C": "temperature",
    "rad/s": "velocity",
    "rad": "position",
    "m/s²": "acceleration",
    "m": "position",
    "m/s": "velocity",
    "N": "effort",
}
ALLOWED: dict[str, tuple[str, ...]] = {
    "battery": ("V",),
    "temperature": ("°C",),
    "acceleration": ("m/s²", "1"),
    "body_rate": ("rad/s", "1"),
    "velocity": ("rad/s", "m/s", "1"),
    "duty": ("1",),
    "voltage": ("V", "1"),
    "effort": ("N·m", "N", "1", "m/s²"),
    "current": ("A", "1"),
    "position": ("rad", "m", "1"),
}
"""Quantity to the units of the contract that a signal of it may have."""

_SCORE_OF_UNIT = 0.8  # of a name that says nothing but a unit
_SHORTEST_PART = 4  # letters of a word that is looked for inside of a longer one


@dataclass(frozen=True)
class Said:
    """What a name says.

    Attributes:
        quantity: one of battery, temperature, acceleration, body_rate, velocity, duty, voltage, effort, current,
            position; empty if none.
        score: how clearly, from 0 to 1.
        commanded: whether it is what was asked for.
        other: whether it is something that is no column: an error, a limit, an angular acceleration.
        part: the words that are left: of which joint or side.
        words: all words.
    """

    quantity: str
    score: float
    commanded: bool
    other: bool
    part: tuple[str, ...]
    words: tuple[str, ...]


def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case, numbers apart from letters: "leftArm.q[3]" is left arm q 3."""
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    spaced = re.sub(r"(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", " ", spaced)
    return tuple(word.lower() for word in re.split(r"[^A-Za-z0-9]+", spaced) if word)


def said_by(name: str) -> Said:
    """Return what a signal's name says."""
    words, unit = words_of(quantity_words(name)), unit_in(name)
    if unit == "rpm" and not any(word in _WORDS["velocity"] for word in words):
        words = (*words, "rpm")
    quantity, score, used = _quantity(words)
    if not quantity:
        quantity, score, used = _quantity(words_of(name))  # "AppliedVolts": its unit is all that is said
    if not quantity:
        quantity, score = _by_unit(unit)
    commanded = bool(COMMANDED & set(words))
    if commanded and not quantity:
        quantity, score = "position", 0.6  # a target without a word of its own is mostly a position
    part = tuple(
        w for w in words if w not in used and w not in COMMANDED and w not in _SAME and w not in _DOT
    )
    other = bool(_OTHER & set(words)) or unit in FOREIGN
    if quantity and not allows(quantity, unit):
        quantity, score, other = "", 0.0, True  # "battery_current_A" is neither
    return Said(quantity, score, commanded, other, part, words)


def allows(quantity: str, unit: str | None) -> bool:
    """Whether a signal in a unit may be of a quantity; True where the unit is unknown."""
    found = conversion(unit) if unit else None
    return found is None or found[0] in ALLOWED[quantity]


def is_preferred(said: Said) -> bool:
    """Whether a name says that it was measured."""
    return bool(_PREFERRED & set(said.words))


def _quantity(words: tuple[str, ...]) -> tuple[str, float, set[str]]:
    found: dict[str, set[str]] = {}
    have = set(words) - ({"u"} if "phase" in words else set())  # one of U, V, W
    for quantity, names in _WORDS.items():
        if used := have & set(names):
            found[quantity] = used
    if {"applied", "output"} <= set(words) or {"percent", "output"} <= set(words):
        found.setdefault("duty", {"output"})
    if not found:
        found = _inside(words)
    if "position" in found and "velocity" not in found and _DOT & set(words):
        found["velocity"] = found["position"]
    if len(found) > 1 and found.get("current") == {"current"}:
        del found["current"]  # "current position" is the present one
    if not found:
        return "", 0.0, set()
    quantity = next(name for name in _WORDS if name in found)
    used = set().union(*found.values())
    return quantity, max(_WEAK.get(word, 1.0) for word in found[quantity]), used


def _by_unit(unit: str | None) -> tuple[str, float]:
    found = conversion(unit) if unit else None
    return (_OF_UNIT[found[0]], _SCORE_OF_UNIT) if found and found[0] in _OF_UNIT else ("", 0.0)


def _inside(words: tuple[str, ...]) -> dict[str, set[str]]:
    """Return quantities whose names stand inside of a longer word, as in "motorvoltage"."""
    found: dict[str, set[str]] = {}
    for quantity, names in _WORDS.items():
        for name in names:
            if len(name) >= _SHORTEST_PART and (used := {word for word in words if name in word}):
                found.setdefault(quantity, set()).update(used)
    return found
