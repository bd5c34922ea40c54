"""Units that people log: by how much a number is then too large, and how a mapping says so."""

import numpy as np

from simgap.consistency.transformation import Transformation, lines, scaled

_DEGREE, _TURN = 180.0 / np.pi, 1.0 / (2.0 * np.pi)

# Odds: degrees are the unit of most tools, rotations that of many motor controllers; the rest is seen in one faulty log
# out of thirty or so.
_COMMON, _USUAL, _RARE = 0.06, 0.03, 0.015

Unit = tuple[str, float, float, str]
"""Name of the cause, recorded over true, odds, and what a mapping says."""

ANGLE: tuple[Unit, ...] = (
    ("degrees", _DEGREE, _COMMON, "unit: deg"),
    ("rotations", _TURN, _COMMON, "unit: rev"),
    ("milli", 1e3, _RARE, "scale: 0.001"),
)
ANGULAR_RATE: tuple[Unit, ...] = (
    ("degrees", _DEGREE, _COMMON, "unit: deg/s"),
    ("rotations", _TURN, _COMMON, "unit: rev/s"),
    ("turns_per_minute", 60.0 * _TURN, _COMMON, "unit: rpm"),
    ("milli", 1e3, _RARE, "scale: 0.001"),
)
LENGTH: tuple[Unit, ...] = (
    ("millimetres", 1e3, _COMMON, "unit: mm"),
    ("centimetres", 1e2, _USUAL, "unit: cm"),
    ("feet", 1.0 / 0.3048, _USUAL, "scale: 0.3048"),
    ("inches", 1.0 / 0.0254, _USUAL, "scale: 0.0254"),
)
COUNTS: tuple[Unit, ...] = (
    ("counts", 0.5, _RARE, "scale: 2"),
    ("counts", 2.0, _RARE, "scale: 0.5"),
)
SPEED: tuple[Unit, ...] = (
    ("millimetres", 1e3, _COMMON, "unit: mm/s"),
    ("centimetres", 1e2, _USUAL, "unit: cm/s"),
    ("feet", 1.0 / 0.3048, _USUAL, "scale: 0.3048"),
    ("inches", 1.0 / 0.0254, _USUAL, "scale: 0.0254"),
    ("per_minute", 60.0, _RARE, "scale: 0.016667"),
)
FORCE: tuple[Unit, ...] = (
    ("g_units", 1.0 / 9.80665, _COMMON, "unit: g"),
    ("g_units", 1e3 / 9.80665, _USUAL, "unit: mg"),
)
TORQUE: tuple[Unit, ...] = (("milli", 1e3, _USUAL, "unit: mN·m"), ("centi", 1e2, _RARE, "scale: 0.01"))
PUSH: tuple[Unit, ...] = (("milli", 1e3, _USUAL, "unit: mN"),)
VOLTAGE: tuple[Unit, ...] = (("milli", 1e3, _USUAL, "unit: mV"),)
CURRENT: tuple[Unit, ...] = (("milli", 1e3, _USUAL, "unit: mA"),)

SUPPLIES = (4.2, 5.0, 6.0, 7.4, 9.0, 11.1, 12.0, 14.8, 18.5, 22.2, 24.0, 36.0, 48.0)
"""Voltages of supplies, V: one lithium cell to ten, lead batteries, servos and power bricks."""

CLOCK: tuple[Unit, ...] = (
    ("time_unit", 1e3, _COMMON, "unit: ms"),
    ("time_unit", 1e6, _USUAL, "unit: us"),
    ("time_unit", 1e9, _USUAL, "unit: ns"),
)


def in_units(
    column: str, columns: tuple[str, ...], units: tuple[Unit, ...], share: float = 1.0
) -> list[Transformation]:
    """Return a transformation for each unit that columns may be in; `share` lowers the odds."""
    return [scaled(name, column, columns, factor, share * odds, key) for name, factor, odds, key in units]


def in_two_units(
    column: str, pairs: tuple[tuple[tuple[str, ...], tuple[Unit, ...]], ...], share: float = 1.0
) -> list[Transformation]:
    """Return the transformations in which two groups of columns have the same other unit.

    Args:
        column: as both together are named.
        pairs: each group with its units.
        share: that lowers the odds.
    """
    (first, units), (second, others) = pairs
    found = []
    for name, factor, odds, key in units:
        for twin in (unit for unit in others if unit[0] == name and (unit[1] == factor)):
            found.append(_both(name, column, first, second, factor, share * odds, key, twin[3]))
    return found


def _both(
    suspected: str,
    column: str,
    first: tuple[str, ...],
    second: tuple[str, ...],
    factor: float,
    odds: float,
    key: str,
    other: str,
) -> Transformation:
    one = scaled(suspected, column, (*first, *second), factor, odds, key)
    keys = dict.fromkeys(first, key) | dict.fromkeys(second, other)
    remedy = lines({name: f"from: {name}, {unit}" for name, unit in keys.items()})
    return Transformation(suspected, column, one.columns, odds, one.mend, remedy)


def duty(column: str, columns: tuple[str, ...], largest: float, supply: float) -> list[Transformation]:
    """Return the transformations in which a voltage is a share of the supply, or a percentage of it.

    Args:
        column: as it is named.
        columns: that it touches.
        largest: value in them.
        supply: V; NaN where it is not known.
    """
    supplies = (supply,) if 1.0 < supply < 100.0 else SUPPLIES
    found = []
    for whole, name, odds in ((1.0, "duty", _COMMON), (100.0, "percent", _USUAL)):
        # A share is one at most; an overdriven motor has a little more.
        if 0.1 * whole < largest <= 2.0 * whole:
            for volts in supplies:
                key = f"scale: {volts / whole:.4g}"
                words = f"a {name} of a supply of some {volts:.3g} V"
                found.append(scaled(name, column, columns, whole / volts, odds / len(supplies), key, words))
    return found
