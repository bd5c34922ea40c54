"""What a person may write in a platform file instead of the plain keys: a motor's name, a wheel's diameter, a size."""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from simgap.errors import InputError
from simgap.platforms.joint import Joint
from simgap.platforms.motors import motor_named
from simgap.platforms.swerve import Swerve

ASSUMPTIONS = "assumptions"
"""The key of a platform that lists, as sentences, what was assumed when it was written."""

_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254, "ft": 0.3048}
_NAMED = ("name", "count", "gear_ratio")


@dataclasses.dataclass(frozen=True)
class Plain:
    """A platform in plain keys.

    Attributes:
        values: the keys of docs/contract.md.
        assumptions: what the platform does not say and was assumed, one sentence each.
    """

    values: dict[str, Any]
    assumptions: tuple[str, ...] = ()


def plain(chosen: type, values: Mapping[str, Any], where: str) -> Plain:
    """Return a platform in the plain keys of its kind.

    Args:
        chosen: the class of its kind.
        values: the keys of the platform file, without its kind.
        where: the configuration key to name in an error.

    Raises:
        InputError: on an unknown motor, a wrong size or wheel, or two keys that say the same.
    """
    changed = dict(values)
    assumptions = _sentences(changed.pop(ASSUMPTIONS, None), f"{where}.{ASSUMPTIONS}")
    if chosen is Joint:
        return Plain(_joint(changed, where), assumptions)
    if chosen is Swerve:
        drive = _with_wheel(_with_motors(changed, where), where)
        return _with_size(drive, assumptions, where)
    return Plain(changed, assumptions)


def _sentences(given: Any, where: str) -> tuple[str, ...]:
    if given is None:
        return ()
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise InputError(f"a list of sentences is needed, not {given!r}", where, "correct the platform file")
    return tuple(str(sentence) for sentence in given)


def _joint(values: dict[str, Any], where: str) -> dict[str, Any]:
    named = _named(values.get("motor"), f"{where}.motor")
    if named is None:
        return values
    name, count, gear_ratio = named
    motor = motor_named(name, f"{where}.motor").of_joint(count, 1.0 if gear_ratio is None else gear_ratio)
    return values | {"motor": motor}


def _with_motors(values: dict[str, Any], where: str) -> dict[str, Any]:
    changed = dict(values)
    for group in ("drive", "steer"):
        axis, place = values.get(group), f"{where}.{group}"
        if not isinstance(axis, Mapping):
            continue
        named = _named(axis.get("motor"), f"{place}.motor")
        if named is None:
            continue
        name, count, gear_ratio = named
        if gear_ratio is not None and "gear_ratio" in axis:
            raise InputError("'gear_ratio' is given twice", place, "give it beside the motor only")
        given = {} if gear_ratio is None else {"gear_ratio": gear_ratio}
        changed[group] = {**axis, **given, "motor": motor_named(name, f"{place}.motor").of_axis(count)}
    return changed


def _named(motor: Any, where: str) -> tuple[Any, int, float | None] | None:
    """Return name, count and gear ratio of a motor that is given by its name; None for any other."""
    if isinstance(motor, str):
        return motor, 1, None
    if not isinstance(motor, Mapping) or "name" not in motor:
        return None
    for key in motor:
        if key not in _NAMED:
            remedy = f"give {', '.join(_NAMED)}, or the motor's constants without a name"
            raise InputError(f"unknown key {key!r} for a motor that is named", where, remedy)
    count = motor.get("count", 1)
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise InputError(f"a whole number of motors is needed, not {count!r}", f"{where}.count", "count them")
    gear_ratio = motor.get("gear_ratio")
    return (
        motor["name"],
        count,
        None if gear_ratio is None else _positive(gear_ratio, f"{where}.gear_ratio"),
    )


def _with_wheel(values: dict[str, Any], where: str) -> dict[str, Any]:
    given = [key for key in ("wheel_radius", "wheel_diameter", "wheel") if key in values]
    if len(given) > 1:
        raise InputError(f"{given[0]!r} and {given[1]!r} say the same", where, "give one of them")
    if not given or given == ["wheel_radius"]:
        return values
    rest = {key: value for key, value in values.items() if key != given[0]}
    place = f"{where}.{given[0]}"
    diameter = values[given[0]] if given == ["wheel_diameter"] else _wheel(values["wheel"], place)
    return rest | {"wheel_radius": 0.5 * _positive(diameter, place)}


def _wheel(wheel: Any, where: str) -> float:
    if not isinstance(wheel, Mapping) or set(wheel) != {"diameter", "unit"}:
        raise InputError(f"is {wheel!r}", where, "give it as {diameter: 4, unit: in}")
    unit = wheel["unit"]
    if unit not in _METRES:
        raise InputError(f"unknown unit {unit!r}", f"{where}.unit", f"use one of {', '.join(_METRES)}")
    return _METRES[unit] * _positive(wheel["diameter"], f"{where}.diameter")


def _with_size(values: dict[str, Any], assumptions: tuple[str, ...], where: str) -> Plain:
    """Return a swerve drive with the inertia of a uniform rectangle about its centre, m·(l² + w²)/12, for its size."""
    if "size" not in values:
        return Plain(values, assumptions)
    rest = {key: value for key, value in values.items() if key != "size"}
    size, place = values["size"], f"{where}.size"
    if "inertia" in values:
        raise InputError("'inertia' and 'size' say the same", where, "give one of them")
    if isinstance(size, str) or not isinstance(size, Sequence) or len(size) != 2:
        raise InputError(
            f"a list of length and width in m is needed, not {size!r}", place, "see docs/contract.md"
        )
    length, width = (_positive(side, f"{place}[{index}]") for index, side in enumerate(size))
    mass = _positive(values.get("mass"), f"{where}.mass")
    inertia = mass * (length**2 + width**2) / 12.0
    said = (
        f"The inertia of the drive, {inertia:.3g} kg·m², is that of a uniform rectangle of {length:g} m by "
        f"{width:g} m: measure it, if you can."
    )
    return Plain(rest | {"inertia": inertia}, (*assumptions, said))


def _positive(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < float("inf"):
        raise InputError(f"a positive number is needed, not {value!r}", where, "correct the platform file")
    return float(value)
