"""Answer key of a quadrotor case: its effects and their equivalent parameters."""

from typing import Any

from simgap.plants.airframe import Airframe
from simgap.plants.case import PlantCase
from simgap.plants.concealable import CONCEALABLE, OUTSIDE
from simgap.plants.concealment import KEY_SCHEMA, entry
from simgap.plants.flight import Log
from simgap.plants.lumped import LAWS, lumped, lumped_in_wind, lumped_sag
from simgap.plants.outside import SHOWS_IN
from simgap.platforms import Quadrotor

_ORDER = {name: place for place, name in enumerate(CONCEALABLE)}


def answer_key(airframe: Airframe, platform: Quadrotor, case: PlantCase, log: Log) -> dict[str, Any]:
    """Return the key of a case; effects at their neutral strength are absent.

    A force of the plant is richer than any one number. What counts as true is its projection, over the
    flights as flown, on the law that a diagnosis would fit; where a wind blows, that of all forces of the air
    together on their laws and the wind's push.
    """
    values = {
        name: _parameters(name, given, airframe, platform, log) for name, given in case.concealed.items()
    }
    if "steady_wind" in case.concealed:
        values |= lumped_in_wind([name for name in values if name in LAWS], airframe, platform, log)
    if case.arm > 0 and "angular_drag" not in values:
        damping = lumped("angular_drag", airframe, platform, log)
        values |= {"angular_drag": {"coefficient": damping}} if damping > 0 else {}
    effects = [entry(name, values[name], _units(name)) for name in sorted(values, key=_ORDER.__getitem__)]
    return {
        "schema": KEY_SCHEMA,
        "effects": effects,
        "outside": [_outside(name, case) for name in case.unnamed],
    }


def _parameters(
    name: str, given: dict[str, float], airframe: Airframe, platform: Quadrotor, log: Log
) -> dict[str, float]:
    """Return the parameters of an effect as a diagnosis would name them."""
    if name == "battery_sag":
        return {"sensitivity": lumped_sag(given["sensitivity"], platform, log)}
    if name in LAWS:
        return {"coefficient": lumped(name, airframe, platform, log)}
    if name == "rotor_fault":
        return {parameter: loss for parameter, loss in given.items() if loss != 0}
    return given


def _units(name: str) -> dict[str, str]:
    if name == "steady_wind":
        return {"push_x": "m/s²", "push_y": "m/s²"}
    return {parameter: quantity.unit for parameter, quantity in CONCEALABLE[name].items()}


def _outside(name: str, case: PlantCase) -> dict[str, Any]:
    units = {parameter: quantity.unit for parameter, quantity in OUTSIDE[name].items()}
    return entry(name, case.unnamed[name], units) | SHOWS_IN[name]
