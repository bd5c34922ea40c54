"""Reading of a platform file, with one-line errors."""

import dataclasses
import difflib
import math
import types
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Union, get_args, get_origin, get_type_hints

from simgap.errors import InputError
from simgap.platforms.joint import Joint
from simgap.platforms.quadrotor import Quadrotor
from simgap.platforms.shorthand import plain
from simgap.platforms.swerve import Swerve

_BY_KIND: dict[str, type] = {cls.kind: cls for cls in (Joint, Quadrotor, Swerve)}
_MAY_BE_ZERO = {"gravity_torque", "stiffness", "gravity", "derivative", "proportional_std", "derivative_std"}
_MAY_BE_NEGATIVE = {"rotor_positions", "rotor_directions", "module_positions", "gravity_torque"}
_RATIOS = {"thrust_coefficient": "thrust_ratios", "torque_coefficient": "torque_ratios"}
_UNEVEN_MEAN = 1e-3  # that ratios written with three decimals may have beyond one


def platform_from_config(config: Any, where: str = "platform") -> Quadrotor | Swerve | Joint:
    """Build the platform that a configuration describes.

    The kind is the value of `kind`, or else the kind with the most keys in common.

    Args:
        config: a mapping of the keys of docs/contract.md for one kind of platform.
        where: the configuration key to name in an error.

    Raises:
        InputError: on an unknown, missing, negative or non-numeric key, or on no mapping at all.
    """
    chosen, values = _chosen(config, where)
    given = plain(chosen, values, where).values
    return _build(chosen, _with_means(given, where) if chosen is Quadrotor else given, where)


def platform_assumptions(config: Any, where: str = "platform") -> tuple[str, ...]:
    """Return what a platform leaves open and was assumed instead, one sentence each.

    Args:
        config: as for `platform_from_config`.
        where: the configuration key to name in an error.

    Raises:
        InputError: as `platform_from_config`.
    """
    return plain(*_chosen(config, where), where).assumptions


def _chosen(config: Any, where: str) -> tuple[type, dict[str, Any]]:
    """Return the class of the kind, and the keys without the kind."""
    if not isinstance(config, Mapping):
        raise InputError("a mapping of keys is needed here", where, "see the platforms in conf/platform")
    values = dict(config)
    kind = values.pop("kind", None) or values.pop("platform_kind", None)
    if kind is not None and str(kind) not in _BY_KIND:
        raise InputError(f"unknown kind {kind!r}", f"{where}.kind", f"use one of {', '.join(_BY_KIND)}")
    if not values:
        raise InputError(
            "no platform is given", where, "give platform=FILE, or platform=NAME of one that simgap brings"
        )
    return (_BY_KIND[kind] if kind else max(_BY_KIND.values(), key=_in_common(values))), values


def platform_to_config(platform: Quadrotor | Swerve | Joint) -> dict[str, Any]:
    """Return the plain mapping from which `platform_from_config` builds the same platform, without what is absent."""
    given = {key: value for key, value in dataclasses.asdict(platform).items() if value is not None}
    return {"kind": platform.kind} | _listed(given)


def plain_config(config: Any, where: str = "platform") -> dict[str, Any]:
    """Return the keys of a platform without shorthands: a motor by its constants, a wheel by its radius.

    Args:
        config: as for `platform_from_config`.
        where: the configuration key to name in an error.

    Raises:
        InputError: as `platform_from_config`.
    """
    return platform_to_config(platform_from_config(config, where))


def _in_common(values: Mapping[str, Any]) -> Callable[[type], int]:
    return lambda cls: len(values.keys() & {field.name for field in dataclasses.fields(cls)})


def _listed(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _listed(entry) for key, entry in value.items()}
    return [_listed(entry) for entry in value] if isinstance(value, tuple) else value


def _with_means(values: dict[str, Any], where: str) -> dict[str, Any]:
    """Return the keys of a quadrotor, a list of coefficients of its rotors as their mean and ratios to it."""
    changed = dict(values)
    for key, ratios in _RATIOS.items():
        given, place = values.get(key), f"{where}.{key}"
        if isinstance(given, Sequence) and not isinstance(given, str):
            if values.get(ratios) is not None:
                raise InputError(f"is a list, and there is {ratios!r} too", place, "give one of them")
            each = _sequence(tuple[float, float, float, float], given, place, key)
            mean = sum(each) / len(each)
            changed |= {key: mean, ratios: [entry / mean for entry in each]}
        elif values.get(ratios) is not None:
            each = _sequence(tuple[float, float, float, float], values[ratios], f"{where}.{ratios}", ratios)
            _check_mean(sum(each) / len(each), f"{where}.{ratios}", key)
    return changed


def _check_mean(mean: float, where: str, key: str) -> None:
    if abs(mean - 1.0) > _UNEVEN_MEAN:
        raise InputError(f"must have a mean of 1, has {mean:.4g}", where, f"put the factor into {key}")


def _build(cls: type, values: Any, where: str) -> Any:
    if not isinstance(values, Mapping):
        raise InputError("a mapping of keys is needed here", where, "see the platforms in conf/platform")
    fields = {field.name: field for field in dataclasses.fields(cls)}
    hints = get_type_hints(cls)
    for key in values:
        if key not in fields:
            near = difflib.get_close_matches(str(key), fields, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else f"known keys: {', '.join(fields)}"
            raise InputError(f"unknown key {key!r} for a {cls.__name__.lower()}", where, remedy)
    lost = [name for name, field in fields.items() if name not in values and _is_needed(field)]
    if len(lost) == 1:
        raise InputError(f"key {lost[0]!r} is missing", where, "give it (see docs/contract.md)")
    if lost:
        raise InputError(
            f"keys {', '.join(map(repr, lost))} are missing", where, "give them (see docs/contract.md)"
        )
    return cls(**{key: _value(hints[key], value, f"{where}.{key}", key) for key, value in values.items()})


def _is_needed(field: dataclasses.Field[Any]) -> bool:
    return field.default is dataclasses.MISSING


def _value(hint: Any, value: Any, where: str, key: str) -> Any:
    if get_origin(hint) in (types.UnionType, Union):
        if value is None:
            return None
        hint = next(entry for entry in get_args(hint) if entry is not type(None))
    if dataclasses.is_dataclass(hint):
        return _build(hint, value, where)  # type: ignore[arg-type]
    if get_origin(hint) is tuple:
        return _sequence(hint, value, where, key)
    return _number(value, where, key, int if hint is int else float)


def _sequence(hint: Any, value: Any, where: str, key: str) -> tuple:
    arguments = get_args(hint)
    length = 4 if arguments[-1] is Ellipsis else len(arguments)
    if isinstance(value, str) or not hasattr(value, "__len__") or len(value) != length:
        raise InputError(f"a list of {length} is needed, not {value!r}", where, "see docs/contract.md")
    return tuple(_value(arguments[0], entry, f"{where}[{index}]", key) for index, entry in enumerate(value))


def _number(value: Any, where: str, key: str, convert: type) -> float | int:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"a finite number is needed, not {value!r}", where, "correct the platform file")
    if key == "rotor_directions" and value not in (1, -1):
        raise InputError(f"{value!r} is neither +1 nor -1", where, "give the sense of the reaction torque")
    if value < 0 and key not in _MAY_BE_NEGATIVE:
        raise InputError(f"must not be negative, is {value}", where, "correct the platform file")
    if value == 0 and key not in _MAY_BE_NEGATIVE | _MAY_BE_ZERO:
        raise InputError("must not be zero", where, "correct the platform file")
    return convert(value)
