"""The unit of an entry of a WPILib DataLog: from its metadata, from its name, or none."""

import json
import re

from simgap.recordings.units import conversion

_NAMES = {
    "volt": "V", "ampere": "A", "amp": "A", "second": "s", "celsius": "°C",
    "meter": "m", "inch": "in", "foot": "ft", "radian": "rad", "degree": "deg", "rotation": "rev",
    "meter per second": "m/s", "inch per second": "in/s", "foot per second": "ft/s",
    "radian per second": "rad/s", "degree per second": "deg/s", "rotation per second": "rev/s",
    "rotation per minute": "rpm",
}  # fmt: skip
# WPILib, wpiunits, `Units`: the names of its units, in the singular; C++ and AdvantageKit write them in the plural

_PLURALS = {
    "inches": "inch",
    "feet": "foot",
    "turns": "rotation",
    "turn": "rotation",
    "revolution": "rotation",
}

_PER_SECOND = r"Per(?:Sec|Second|Seconds|S)"
_ENDINGS: tuple[tuple[str, str], ...] = (
    (rf"(?:Radians|Radian|Rads|Rad){_PER_SECOND}", "rad/s"),
    (rf"(?:Degrees|Degree|Degs|Deg){_PER_SECOND}", "deg/s"),
    (rf"(?:Rotations|Rotation|Rots|Rot|Revolutions|Revs|Rev){_PER_SECOND}", "rev/s"),
    (r"(?:(?:Rotations|Rotation|Rot|Revolutions|Revs|Rev)Per(?:Min|Minute)|RPM|Rpm)", "rpm"),
    (rf"(?:Meters|Meter){_PER_SECOND}", "m/s"),
    (rf"(?:Feet|Foot){_PER_SECOND}", "ft/s"),
    (r"(?:Radians|Rads|Rad)", "rad"),
    (r"(?:Degrees|Degs|Deg)", "deg"),
    (r"(?:Rotations|Rots|Revolutions|Revs)", "rev"),
    (r"Meters", "m"),
    (r"Inches", "in"),
    (r"Feet", "ft"),
    (r"(?:Volts|Voltage)", "V"),
    (r"(?:Amps|Amperes)", "A"),
    (r"Celsius", "°C"),
)  # the words that AdvantageKit and WPILib's examples end names with
_BY_ENDING = tuple((re.compile(rf".*{words}$"), unit) for words, unit in _ENDINGS)
_DEVICE = re.compile(r"(?:^|/)Phoenix6/(?:TalonFX|TalonFXS|CANcoder)[^/]*/(?P<signal>\w+)$")
_DEVICE_UNITS = {
    "MotorVoltage": "V", "SupplyVoltage": "V", "SupplyCurrent": "A", "StatorCurrent": "A", "TorqueCurrent": "A",
    "Position": "rev", "Velocity": "rev/s", "RotorPosition": "rev", "RotorVelocity": "rev/s",
    "AbsolutePosition": "rev", "DeviceTemp": "°C",
}  # fmt: skip
# CTRE, "Phoenix 6 API", status signals of TalonFX and CANcoder: rotations and rotations a second


def unit_of(name: str, metadata: str) -> str | None:
    """Return the unit of an entry; None where neither its metadata nor its name says one.

    Args:
        name: of the entry.
        metadata: as the file holds it: JSON with the key `unit`, the name of a unit, or something else.
    """
    return unit_named(_declared(metadata)) or _unit_by_name(name)


def unit_named(text: str) -> str | None:
    """Return a unit by its name in words (`Rotation per Second`) or its sign (`rad/s`); None where it is neither."""
    if not text:
        return None
    words = [_PLURALS.get(word, word) for word in re.split(r"[\s_]+", text.strip().lower())]
    words = [word if word in _PLURALS.values() else word.removesuffix("s") for word in words]
    if (found := _NAMES.get(" ".join(words))) is not None:
        return found
    return text.strip() if conversion(text) is not None and conversion(text) != ("1", 1.0, 0.0) else None


def _declared(metadata: str) -> str:
    if not metadata.startswith("{"):
        return metadata
    try:
        content = json.loads(metadata)
    except (ValueError, RecursionError):
        return ""
    unit = content.get("unit", content.get("units", "")) if isinstance(content, dict) else ""
    return unit if isinstance(unit, str) else ""


def _unit_by_name(name: str) -> str | None:
    if (device := _DEVICE.search(name)) is not None:
        return _DEVICE_UNITS.get(device["signal"])
    last = re.sub(r"\[\d+\]$", "", name.rsplit("/", 1)[-1]).strip()
    if (bracket := re.search(r"\(([^()]+)\)$", last)) is not None:
        return unit_named(bracket[1])
    return next((unit for pattern, unit in _BY_ENDING if pattern.match(last)), None)
