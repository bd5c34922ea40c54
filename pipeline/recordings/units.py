"""Units that a recording may declare, and their conversion to those of the contract."""

import math

from simgap.errors import InputError

_STANDARD_GRAVITY = 9.80665  # m/s², the g in which accelerometers are scaled

_ALIASES = {
    "": "1", "-": "1", "none": "1", "dimensionless": "1", "unitless": "1",
    "m/s2": "m/s²", "m/s^2": "m/s²", "m/s**2": "m/s²",
    "Nm": "N·m", "N*m": "N·m", "N m": "N·m", "N.m": "N·m",
    "degC": "°C", "C": "°C", "celsius": "°C",
    "sec": "s", "seconds": "s", "volt": "V", "ampere": "A",
    "radians": "rad", "radian": "rad", "degrees": "deg", "degree": "deg", "°": "deg",
    "°/s": "deg/s", "dps": "deg/s",
    "µs": "us", "μs": "us", "RPM": "rpm", "rev/min": "rpm", "rotations": "rev", "revolutions": "rev",
    "%": "percent", "mNm": "mN·m", "rotations/s": "rev/s", "rps": "rev/s",
    "rad/sec": "rad/s", "radians/s": "rad/s", "radians/sec": "rad/s", "rad s-1": "rad/s", "rad/s^1": "rad/s",
    "deg/sec": "deg/s", "degrees/s": "deg/s", "degrees/sec": "deg/s", "turns": "rev", "turn": "rev",
    "turns/s": "rev/s", "rotations/sec": "rev/s", "rotation": "rev", "revolution": "rev", "rev/sec": "rev/s",
    "m/sec": "m/s", "metres": "m", "meters": "m", "meter": "m", "metre": "m", "meters/s": "m/s",
    "volts": "V", "Volts": "V", "Volt": "V", "amps": "A", "Amps": "A", "amp": "A", "amperes": "A",
    "second": "s", "secs": "s", "Seconds": "s", "msec": "ms", "milliseconds": "ms", "millis": "ms",
    "usec": "us", "microseconds": "us", "micros": "us", "nsec": "ns", "nanoseconds": "ns", "nanos": "ns",
    "N-m": "N·m", "N⋅m": "N·m", "newton": "N", "newtons": "N", "Newton": "N", "Celsius": "°C", "ºC": "°C", "°c": "°C",
    "U/min": "rpm", "1/min": "rpm", "r/min": "rpm", "rads": "rad", "ratio": "1", "rot": "rev",
    "Ncm": "N·cm", "N*cm": "N·cm", "N.cm": "N·cm", "N cm": "N·cm",
    "kgcm": "kgf·cm", "kg*cm": "kgf·cm", "kg.cm": "kgf·cm", "kg cm": "kgf·cm", "kg·cm": "kgf·cm", "kgf.cm": "kgf·cm",
}  # fmt: skip

_CONVERSIONS: dict[str, tuple[str, float, float]] = {
    "deg": ("rad", math.pi / 180, 0.0),
    "rev": ("rad", 2 * math.pi, 0.0),
    "deg/s": ("rad/s", math.pi / 180, 0.0),
    "rev/s": ("rad/s", 2 * math.pi, 0.0),
    "rpm": ("rad/s", 2 * math.pi / 60, 0.0),
    "in": ("m", 0.0254, 0.0),
    "ft": ("m", 0.3048, 0.0),
    "in/s": ("m/s", 0.0254, 0.0),
    "ft/s": ("m/s", 0.3048, 0.0),
    "mm": ("m", 1e-3, 0.0),
    "cm": ("m", 1e-2, 0.0),
    "mm/s": ("m/s", 1e-3, 0.0),
    "cm/s": ("m/s", 1e-2, 0.0),
    "g": ("m/s²", _STANDARD_GRAVITY, 0.0),
    "mg": ("m/s²", 1e-3 * _STANDARD_GRAVITY, 0.0),
    "ms": ("s", 1e-3, 0.0),
    "us": ("s", 1e-6, 0.0),
    "ns": ("s", 1e-9, 0.0),
    "mV": ("V", 1e-3, 0.0),
    "mA": ("A", 1e-3, 0.0),
    "mN": ("N", 1e-3, 0.0),
    "mN·m": ("N·m", 1e-3, 0.0),
    "N·cm": ("N·m", 1e-2, 0.0),
    "kgf·cm": ("N·m", 1e-2 * _STANDARD_GRAVITY, 0.0),
    "percent": ("1", 1e-2, 0.0),
    "K": ("°C", 1.0, -273.15),
}

_BASE = ("1", "s", "m", "m/s", "m/s²", "rad", "rad/s", "V", "A", "N", "N·m", "°C")

KNOWN = (*_BASE, *_CONVERSIONS)
"""Every unit that can be declared, without the other spellings of the same."""


def usual_name(spelling: str) -> str:
    """Return the name of a unit that is spelled in another way: of "degrees", deg; an unknown one as it stands."""
    return _ALIASES.get(spelling.strip(), spelling.strip())


def conversion(unit: str) -> tuple[str, float, float] | None:
    """Return (contract unit, factor, offset): contract value = factor · value + offset; None if unknown."""
    name = usual_name(unit)
    return (name, 1.0, 0.0) if name in _BASE else _CONVERSIONS.get(name)


def factor_and_offset(unit: str, expected: str, where: str) -> tuple[float, float]:
    """Return (factor, offset) of a declared unit: contract value = factor · value + offset.

    Args:
        unit: as it is declared.
        expected: unit of the contract that it has to be one of.
        where: what to name in an error.

    Raises:
        InputError: when the unit is unknown, or one of another quantity.
    """
    found = conversion(unit)
    if found is None:
        raise InputError(f"unknown unit {unit!r}", where, f"use one of {', '.join(KNOWN)}")
    if found[0] != expected:
        raise InputError(f"unit {unit!r} does not fit", where, f"a unit of {expected} is needed")
    return found[1], found[2]
