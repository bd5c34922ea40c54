"""What drives a joint: an effort, a voltage, a duty of a supply, or a commanded position."""

from dataclasses import dataclass, field

import numpy as np

from simgap.logs.common_times import values_at
from simgap.logs.guessing.motion import moves, range_of, wrap_of
from simgap.logs.guessing.parts import Named, Part, choices
from simgap.logs.guessing.words import said_by
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import SURE, Proposed
from simgap.recordings.units import conversion

_SUPPLY = (3.0, 60.0)  # V: from one lithium cell to the limit of protective low voltage
_STEADY = 0.3  # of its mean; a supply sags by less, a driving voltage goes through zero
_FOLLOWED = 0.5  # of a position's variance, which its target explains at least
_FULL_DUTY = (1.0, 100.0)  # of what is a share, and what is in percent
_RATED = 0.92  # a torque named in the notation of robotics libraries, which use SI units
_RAW_CURRENT = ("units", "counts", "raw", "ticks", "lsb")


@dataclass(frozen=True)
class Driven:
    """What drives a joint, and what was seen beside it.

    Attributes:
        columns: proposed columns that drive it; empty where there is none.
        notes: sentences for a person.
        seen: quantity to the name of a signal that is not enough: a duty, a current, a target.
    """

    columns: dict[str, Proposed]
    notes: tuple[str, ...] = ()
    seen: dict[str, str] = field(default_factory=dict)


def inputs_of(log: Log, named: list[Named], part: Part, unit: str, position: Signal | None) -> Driven:
    """Propose what drives the joint of a part, with supply, current and temperature where they are sure.

    Args:
        log: with times in s.
        named: signals with what their names say.
        part: of the machine.
        unit: of its position.
        position: of the joint; None where there is none.
    """
    columns: dict[str, Proposed] = {}
    seen: dict[str, str] = {}
    near = frozenset(said_by(position.name).words) if position is not None else frozenset()
    sliding = (conversion(unit) or ("rad", 1.0, 0.0))[0] == "m"
    supply = supply_of(log, named, part)
    for commanded in (False, True):
        for each in choices(named, "effort", commanded, part, near):
            _keep_best(columns, "effort", _effort(log.signals[each.name], each, "N" if sliding else "N·m"))
        for each in choices(named, "voltage", commanded, part, near):
            if supply is None or each.name != supply.source.signal:
                _keep_best(columns, "voltage", _voltage(log.signals[each.name], each))
    duty = [each for commanded in (False, True) for each in choices(named, "duty", commanded, part, near)]
    if duty and "voltage" not in columns:
        seen["duty"] = duty[0].name
        if supply is not None:
            _keep_best(columns, "voltage", _duty(log.signals[duty[0].name], duty[0], supply))
    targets = choices(named, "position", True, part, near)
    wanted = targets or choices(named, "velocity", True, part, near)
    if wanted:
        seen["target"] = wanted[0].name
    if (
        targets and position is not None and not columns.keys() & {"effort", "voltage"}
    ):  # else it does not count
        found = _target(log.signals[targets[0].name], targets[0], unit, position)
        _keep_best(columns, "position_command", found)
    driven = dict(columns)
    if driven:
        driven |= _beside(log, named, part, supply)
    seen |= {each.said.quantity: each.name for each in choices(named, "current", False, part, near)[:1]}
    return Driven(driven, _notes(log, driven), seen)


def advice_for_input(log: Log, driven: Driven) -> str:
    """Return how to log what drives a joint, by what there is of it already."""
    if "duty" in driven.seen:
        return (
            f"{driven.seen['duty']!r} is a duty: log the supply voltage, too, or give voltage: "
            f"{{from: {driven.seen['duty']}, unit: V, scale: VOLTS_AT_FULL_DUTY}}"
        )
    if "current" in driven.seen:
        name = driven.seen["current"]
        raw = log.signals[name].unit in _RAW_CURRENT or log.signals[name].unit is None
        per = "N·m per unit" if raw else "torque constant times gear ratio"
        return f"{name!r} is a current: give effort: {{from: {name!r}, unit: N·m, scale: {per}}}, or log the torque"
    if "target" in driven.seen:
        return (
            f"{driven.seen['target']!r} is a target: log the controller's output, too: its torque, or its duty "
            "and the supply voltage"
        )
    return "log what the controller gives to the motor: its voltage (duty times supply), or its torque or current"


def _keep_best(columns: dict[str, Proposed], name: str, found: Proposed | None) -> None:
    if found is not None and (name not in columns or found.confidence > columns[name].confidence):
        columns[name] = found


def _effort(signal: Signal, named: Named, usual: str) -> Proposed | None:
    found = conversion(signal.unit) if signal.unit else None
    factor = 0.85 if named.said.commanded else 1.0
    if signal.unit and (found is None or found[0] not in ("N·m", "N")):
        return None
    if not np.isfinite(signal.values).any() or range_of(signal) == 0.0:
        return None
    what = "commanded" if named.said.commanded else "by its name"
    if found is not None:
        return Proposed(
            Source(signal.name, signal.unit), round(0.97 * factor, 2), f"{what}, in {signal.unit}"
        )
    if (width := wrap_of(signal)) is not None and width > 256:
        why = f"jumps by {width:.6g}: a number of {int(np.log2(width))} bits without sign, no torque in N·m"
        return Proposed(Source(signal.name), 0.2, why)
    sure = (_RATED if "tau" in named.said.words else 0.8) * named.said.score * factor
    return Proposed(Source(signal.name, usual), round(sure, 2), f"{what}; {usual} is taken, no unit is said")


def _voltage(signal: Signal, named: Named) -> Proposed | None:
    found = conversion(signal.unit) if signal.unit else None
    if signal.unit and (found is None or found[0] != "V"):
        return None
    largest = float(np.nanmax(np.abs(signal.values), initial=0.0))
    if largest == 0.0:
        return None
    factor = found[1] if found else 1.0
    if largest * factor > _SUPPLY[1]:
        return Proposed(Source(signal.name, signal.unit or "mV"), 0.5, f"reaches {largest:.4g}: in mV?")
    if _is_supply(signal, factor):
        return Proposed(Source(signal.name, signal.unit or "V"), 0.4, "hardly changes: is it the supply?")
    if found is not None:
        return Proposed(Source(signal.name, signal.unit), 0.97, f"by its name, in {signal.unit}")
    sure = 0.93 if set(named.said.words) & {"voltage", "volts", "volt"} else 0.6
    return Proposed(Source(signal.name, "V"), sure, f"by its name, up to {largest:.3g} V")


def _is_supply(signal: Signal, factor: float) -> bool:
    values = signal.values[np.isfinite(signal.values)] * factor
    if not len(values):
        return False
    low, high = np.quantile(values, [0.01, 0.99])
    return bool(_SUPPLY[0] <= low and high <= _SUPPLY[1] and high - low < _STEADY * float(np.mean(values)))


def supply_of(log: Log, named: list[Named], part: Part) -> Proposed | None:
    """Propose the supply: by its name, or a voltage that hardly changes."""
    for each in (*choices(named, "battery", False, part), *choices(named, "voltage", False, part)):
        signal = log.signals[each.name]
        found = conversion(signal.unit) if signal.unit else None
        if found is not None and found[0] != "V":
            continue
        for unit, factor in ((signal.unit, found[1]),) if found else (("V", 1.0), ("mV", 1e-3)):
            if _is_supply(signal, factor):
                low, high = (float(q) * factor for q in np.nanquantile(signal.values, [0.01, 0.99]))
                sure = 0.95 if found or unit == "V" else SURE
                return Proposed(Source(each.name, unit), sure, f"stays within {low:.3g} to {high:.3g} V")
    return None


def _duty(signal: Signal, named: Named, supply: Proposed) -> Proposed | None:
    if supply.source.unit != "V" and (conversion(supply.source.unit or "V") or ("", 1.0, 0.0))[1] != 1.0:
        return None
    found = conversion(signal.unit) if signal.unit else None
    largest = float(np.nanmax(np.abs(signal.values), initial=0.0))
    share = found[1] if found else 1.0 if largest <= _FULL_DUTY[0] else 0.01
    if not found and not 0.0 < largest <= _FULL_DUTY[1]:
        return None
    source = Source(signal.name, "V", scale=share, times=supply.source.signal)
    return Proposed(source, 0.75, f"a duty up to {largest:.3g}, times the supply {supply.source.signal!r}")


def _target(signal: Signal, named: Named, unit: str, position: Signal) -> Proposed | None:
    """Propose a commanded position where it has the range of the measured one, which follows it."""
    span, own = range_of(signal), range_of(position)
    if span <= 0.0 or own <= 0.0:
        return None
    declared = conversion(signal.unit) if signal.unit else None
    followed = _correlation(position, signal)
    is_followed = followed**2 > _FOLLOWED
    same = 0.3 < span / own < 3.0 and is_followed
    answer = "follows" if is_followed else "hardly follows"
    why = (
        f"a target with {span / own:.2g} times the range of the position, which {answer} it "
        f"(correlation {followed:.2f})"
    )
    return Proposed(Source(signal.name, signal.unit if declared else unit), 0.93 if same else 0.5, why)


def _correlation(position: Signal, target: Signal) -> float:
    """Return the correlation of a position with a target that is held; 0 where either never changes."""
    told = values_at(target, position.time, held=True)
    known = np.isfinite(told) & np.isfinite(position.values)
    if not known.any():
        return 0.0
    first, second = (values[known] - np.mean(values[known]) for values in (told, position.values))
    size = float(np.sqrt((first @ first) * (second @ second)))
    return float(first @ second) / size if size > 0.0 else 0.0


def _beside(log: Log, named: list[Named], part: Part, supply: Proposed | None) -> dict[str, Proposed]:
    """Return what may stand beside the input: supply, current, temperature, only where it is sure."""
    columns: dict[str, Proposed] = {}
    if supply is not None:
        columns["battery_voltage"] = supply
    for column, base in (("current", "A"), ("temperature", "°C")):
        for each in choices(named, column, False, part)[:1]:
            signal = log.signals[each.name]
            found = conversion(signal.unit) if signal.unit else None
            if found is not None and found[0] == base and moves(signal):
                columns[column] = Proposed(
                    Source(each.name, signal.unit), 0.95, f"by its name, in {signal.unit}"
                )
    return columns


def _notes(log: Log, columns: dict[str, Proposed]) -> tuple[str, ...]:
    return tuple(
        f"{name} is not sure: {found.reason}." for name, found in columns.items() if found.confidence < 0.5
    )
