"""Answer key of a swerve case, in the terms of a diagnosis."""

from collections.abc import Callable
from typing import Any

from simgap.plants.concealment import KEY_SCHEMA, Concealed, entry
from simgap.plants.swerve.chassis import WHEEL_SHARE
from simgap.platforms import Swerve

Stated = dict[str, tuple[float, str]]
"""Value and unit by parameter."""


def answer_key(effects: Concealed, outside: Concealed, platform: Swerve) -> dict[str, Any]:
    """Return the key of a case; effects at their neutral strength are absent.

    `beside` lists what is there with them: to name it is right, to leave it out is no miss.
    """
    entries = []
    for name, values in effects.present().items():
        bare, _, group = name.partition("@")
        stated = LUMPED[bare](values, platform, group) if bare in LUMPED else _plain(name, values, effects)
        entries.append(_entry(name, stated))
    return {
        "schema": KEY_SCHEMA,
        "effects": entries,
        "beside": [_entry(name, stated) for name, stated in _beside(effects).items()],
        "outside": [
            _entry(name, _plain(name, values, outside)) for name, values in outside.present().items()
        ],
    }


def _beside(effects: Concealed) -> dict[str, Stated]:
    """Return what comes with the concealed effects: tyres that slide beyond their grip creep before they do."""
    if "wheel_slip@drive" not in effects or "tyre_creep@drive" in effects:
        return {}
    return {"tyre_creep@drive": {"compliance": (1.0 / effects.get("wheel_slip@drive", "stiffness"), "1")}}


def _plain(name: str, values: dict[str, float], concealed: Concealed) -> Stated:
    return {key: (value, concealed.table[name][key].unit) for key, value in values.items()}


def _entry(name: str, stated: Stated) -> dict[str, Any]:
    values = {key: value for key, (value, _) in stated.items()}
    return entry(name, values, {key: unit for key, (_, unit) in stated.items()})


def _battery_sag(values: dict[str, float], platform: Swerve, group: str) -> Stated:
    """Return controllers that pass all of the battery's voltage on, whatever the battery is like."""
    return {"sensitivity": (1.0, "1")}


def _motor_inductance(values: dict[str, float], platform: Swerve, group: str) -> Stated:
    motor = (platform.drive if group == "drive" else platform.steer).motor
    return {"inductance": (values["time_constant"] * motor.resistance, "H")}


def _wheel_slip(values: dict[str, float], platform: Swerve, group: str) -> Stated:
    """Return the grip over the mass that still follows it when the wheels spin: theirs then does not."""
    return {"friction_coefficient": (values["friction_coefficient"] / (1.0 - WHEEL_SHARE), "1")}


def _tyre_creep(values: dict[str, float], platform: Swerve, group: str) -> Stated:
    return {"compliance": (values["compliance"], "1")}


LUMPED: dict[str, Callable[[dict[str, float], Swerve, str], Stated]] = {
    "battery_sag": _battery_sag,
    "motor_inductance": _motor_inductance,
    "tyre_creep": _tyre_creep,
    "wheel_slip": _wheel_slip,
}
"""Effects whose answer is not simply the plant's own quantities."""
