"""Units become the contract's by a table, never by guess."""

import math

import pytest

from simgap.recordings.contract import KINDS, SLIDING_JOINT_UNITS, channel_units
from simgap.recordings.units import KNOWN, conversion


@pytest.mark.parametrize("kind", KINDS)
def test_the_contracts_units_stay(kind):
    for unit in {"s", *channel_units(kind).values(), *SLIDING_JOINT_UNITS.values()}:
        assert conversion(unit) == (unit, 1.0, 0.0)


@pytest.mark.parametrize(
    ("unit", "value", "contract", "expected"),
    [
        ("deg", 180, "rad", math.pi),
        ("deg/s", -90, "rad/s", -math.pi / 2),
        ("rpm", 60, "rad/s", 2 * math.pi),
        ("rev/s", 0.5, "rad/s", math.pi),
        ("mm", 250, "m", 0.25),
        ("cm", 25, "m", 0.25),
        ("g", 2, "m/s²", 19.6133),
        ("ms", 20, "s", 0.02),
        ("us", 20, "s", 2e-5),
        ("mV", 3700, "V", 3.7),
        ("%", 50, "1", 0.5),
        ("K", 300, "°C", 26.85),
        (" m/s^2 ", 3, "m/s²", 3),
        ("N*m", 3, "N·m", 3),
    ],
)
def test_other_units_are_converted(unit, value, contract, expected):
    name, factor, offset = conversion(unit)
    assert name == contract
    assert factor * value + offset == pytest.approx(expected)


def test_every_known_unit_leads_to_one_of_the_contract():
    contract = {unit for kind in KINDS for unit in channel_units(kind).values()}
    contract |= {"s", *SLIDING_JOINT_UNITS.values()}
    assert {conversion(unit)[0] for unit in KNOWN} == contract


@pytest.mark.parametrize("unit", ["furlong", "Deg", "rad^2", "m / s"])
def test_an_unknown_unit_is_none(unit):
    assert conversion(unit) is None
