"""Answer key of a joint case, in the terms of a diagnosis.

Where the plant is richer than any law with a name, what counts as true is the law that comes nearest to it over the
runs as they were.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from simgap.plants.concealment import KEY_SCHEMA, Concealed, entry
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.hysteresis import nearest_dahl
from simgap.plants.joint.motion import Log
from simgap.plants.joint.supply import AMBIENT
from simgap.platforms import Joint

Stated = dict[str, tuple[float, str]]
"""Value and unit by parameter."""


@dataclass(frozen=True)
class Answered:
    """What the answer may need to know of a case that was run.

    Attributes:
        effects: what it conceals of the catalogue.
        platform: the nominal machine.
        case: as it was run.
        log: what happened.
    """

    effects: Concealed
    platform: Joint
    case: JointCase
    log: Log


def answer_key(outside: Concealed, answered: Answered) -> dict[str, Any]:
    """Return the key of a case; effects at their neutral strength are absent."""
    effects, sliding = answered.effects, answered.case.sliding
    return {
        "schema": KEY_SCHEMA,
        "effects": [
            _entry(
                name,
                LUMPED[name](values, answered) if name in LUMPED else _plain(name, values, effects),
                sliding,
            )
            for name, values in effects.present().items()
        ],
        "outside": [
            _entry(name, _plain(name, values, outside), sliding) for name, values in outside.present().items()
        ],
    }


def _plain(name: str, values: dict[str, float], concealed: Concealed) -> Stated:
    return {key: (value, concealed.table[name][key].unit) for key, value in values.items()}


def _entry(name: str, stated: Stated, sliding: bool) -> dict[str, Any]:
    units = {key: in_metres(unit) if sliding else unit for key, (_, unit) in stated.items()}
    return entry(name, {key: value for key, (value, _) in stated.items()}, units)


def in_metres(unit: str) -> str:
    """Return the unit of a sliding axis for that of a turning one."""
    return unit.replace("N·m", "N").replace("rad", "m")


def _dead_zone(values: dict[str, float], answered: Answered) -> Stated:
    """Return the effort at standstill of the greatest command that does nothing."""
    motor = answered.platform.motor
    if motor is None:
        return {"width": (values["width"], "N·m")}
    ratio = answered.effects.get("motor_constant_error", "ratio")
    per_volt = ratio * motor.torque_constant * motor.gear_ratio / motor.resistance
    return {"width": (per_volt * values["width"], "N·m")}


def _cogging(values: dict[str, float], answered: Answered) -> Stated:
    """Return the first harmonic."""
    amplitude, phase = values["amplitude"], values["phase"]
    return {
        "sine": (-amplitude * np.cos(phase), "N·m"),
        "cosine": (-amplitude * np.sin(phase), "N·m"),
        "cycles": (values["cycles"], "1/rad"),
    }


def _hysteresis(values: dict[str, float], answered: Answered) -> Stated:
    level, displacement = nearest_dahl(answered.log.position, values["level"], values["displacement"])
    return {"level": (level, "N·m"), "displacement": (displacement, "rad")}


def _battery_sag(values: dict[str, float], answered: Answered) -> Stated:
    """Return a drive that passes all of the battery's voltage on, whatever the battery is like."""
    return {"share": (1.0, "1"), "nominal_voltage": (answered.case.supply, "V")}


def _temperature_derating(values: dict[str, float], answered: Answered) -> Stated:
    """Return the line through the share of the cold motor's effort that the warm one has."""
    log = answered.log
    cold = log.cold_effort
    warmer = cold * (log.temperature - AMBIENT)
    columns = np.stack((cold.ravel(), -warmer.ravel()), axis=1)
    (full, lost), *_ = np.linalg.lstsq(columns, log.effort.ravel(), rcond=None)
    return {"coefficient": (lost, "1/K"), "reference": (AMBIENT - (1.0 - full) / lost, "°C")}


def _motor_inductance(values: dict[str, float], answered: Answered) -> Stated:
    motor = answered.platform.motor
    assert motor is not None  # the case was checked
    return {"inductance": (values["time_constant"] * motor.resistance, "H")}


LUMPED: dict[str, Callable[[dict[str, float], Answered], Stated]] = {
    "dead_zone": _dead_zone,
    "cogging": _cogging,
    "hysteresis": _hysteresis,
    "battery_sag": _battery_sag,
    "temperature_derating": _temperature_derating,
    "motor_inductance": _motor_inductance,
}
"""Effects whose answer is not simply the plant's own quantities."""
