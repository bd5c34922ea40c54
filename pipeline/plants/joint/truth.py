"""Answer key of a joint case, in the terms of a diagnosis.

Where the plant is richer than any law with a name, what counts as true is the law that comes nearest to it over the
runs as they were.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import lfilter

from simgap.plants.concealment import KEY_SCHEMA, Concealed, entry
from simgap.plants.joint.axis import bodies
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.hysteresis import nearest_law
from simgap.plants.joint.motion import SETTLING, STEP, Log
from simgap.plants.joint.sensing import filtered
from simgap.plants.joint.supply import AMBIENT, COPPER_SHARE, kept_at_standstill
from simgap.platforms import Joint

_SETTLED = round(SETTLING / STEP)  # steps before the recording, in which the filters settle

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
    if motor is None or answered.platform.controller is not None:
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
    level, displacement, asymmetry = nearest_law(
        answered.log.position, values["level"], values["displacement"]
    )
    return {"level": (level, "N·m"), "displacement": (displacement, "rad"), "asymmetry": (asymmetry, "1")}


def _battery_sag(values: dict[str, float], answered: Answered) -> Stated:
    """Return a drive that passes all of the battery's voltage on, whatever the battery is like."""
    return {"share": (1.0, "1"), "nominal_voltage": (answered.case.supply, "V")}


def _temperature_derating(values: dict[str, float], answered: Answered) -> Stated:
    """Return the line through the share of the cold motor's torque at standstill that the warm one has."""
    log = answered.log
    cold, warmer = log.cold_effort, log.temperature - AMBIENT
    lost = values["coefficient"] * warmer
    share = kept_at_standstill(lost) if answered.platform.motor else 1.0 - lost
    columns = np.stack((cold.ravel(), -(cold * warmer).ravel()), axis=1)
    (full, lost), *_ = np.linalg.lstsq(columns, (cold * share).ravel(), rcond=None)
    found = {"coefficient": (lost, "1/K"), "reference": (AMBIENT - (1.0 - full) / lost, "°C")}
    return found | {"magnets_share": (1.0 - COPPER_SHARE, "1")} if answered.platform.motor else found


def _motor_inductance(values: dict[str, float], answered: Answered) -> Stated:
    motor = answered.platform.motor
    assert motor is not None  # the case was checked
    return {"inductance": (values["time_constant"] * motor.resistance, "H")}


def _flexible_coupling(values: dict[str, float], answered: Answered) -> Stated:
    """Return the linear spring that comes nearest to the hardening one along the twists that occurred."""
    share = values["motor_inertia_share"]
    inertia = answered.platform.inertia * answered.effects.get("inertia_error", "ratio")
    load = (1.0 - share) * inertia
    _, coupling = bodies(answered.effects, inertia, answered.case.size(answered.platform)["effort"])
    assert coupling is not None  # the case was checked
    twist = answered.log.twist
    push = coupling.effort(twist, np.zeros_like(twist))
    frequency = np.sqrt(float((push * twist).sum() / (twist * twist).sum()) / load) / (2.0 * np.pi)
    ratio = coupling.damping / (4.0 * np.pi * load * frequency)
    return {
        "frequency": (frequency, "Hz"),
        "damping_ratio": (ratio, "1"),
        "motor_inertia_share": (share, "1"),
    }


def _velocity_filter(values: dict[str, float], answered: Answered) -> Stated:
    """Return the first-order filter whose output comes nearest to what was recorded."""
    velocity, delay = answered.log.velocity, values["time_constant"]
    recorded = filtered(velocity, delay)
    candidates = delay * np.linspace(0.7, 1.3, 61)
    kept = np.exp(-STEP / candidates)
    errors = [
        np.square(lfilter([1.0 - each], [1.0, -each], velocity, axis=0) - recorded)[_SETTLED:].sum()
        for each in kept
    ]
    return {"time_constant": (float(candidates[int(np.argmin(errors))]), "s")}


LUMPED: dict[str, Callable[[dict[str, float], Answered], Stated]] = {
    "dead_zone": _dead_zone,
    "cogging": _cogging,
    "hysteresis": _hysteresis,
    "battery_sag": _battery_sag,
    "temperature_derating": _temperature_derating,
    "motor_inductance": _motor_inductance,
    "flexible_coupling": _flexible_coupling,
    "velocity_filter": _velocity_filter,
}
"""Effects whose answer is not simply the plant's own quantities."""
