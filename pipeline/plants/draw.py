"""Random draws of machines, recording conditions and effect magnitudes."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from simgap.errors import InputError
from simgap.plants.concealment import Quantity

Random = np.random.Generator


def vary_platform(
    machines: Mapping[str, Mapping[str, Any]], vary: Mapping[str, float], random: Random
) -> tuple[str, dict[str, Any]]:
    """Choose a machine and change what is listed by a random factor.

    Args:
        machines: platform files by name.
        vary: by key of the platform, greatest natural logarithm of the factor.
        random: generator.
    """
    name = sorted(machines)[random.integers(len(machines))]
    told = dict(machines[name])
    for key, most in vary.items():
        factor = math.exp(random.uniform(-most, most))
        if key in told:
            told[key] = _scaled(told[key], factor)
    return name, told


def draw_conditions(table: Mapping[str, Any], random: Random) -> dict[str, Any]:
    """Draw each condition: a number between two bounds (`{from, to}`), one of a list (`{one_of}`), or as it stands."""
    return {key: _condition(value, f"conditions.{key}", random) for key, value in table.items()}


def merged(conditions: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Return conditions with those that a machine has of its own, section by section."""
    both = {key: conditions[key] | own[key] for key in conditions if isinstance(own.get(key), dict)}
    return {**conditions, **own, **both}


def draw_effect(
    quantities: Mapping[str, Quantity], defaults: Mapping[str, float], around: float, random: Random
) -> dict[str, float]:
    """Draw the values of an effect around its strength: magnitudes, signs, directions.

    Args:
        quantities: of the effect; the first is its strength.
        defaults: the values to draw around.
        around: greatest natural logarithm of the factor by which each value is changed.
        random: generator.
    """
    values = {name: _around(quantities[name], value, around, random) for name, value in defaults.items()}
    for names in _vectors(quantities):
        turned = _turned([values[name] for name in names], quantities[names[0]].low < 0, random)
        values |= dict(zip(names, turned, strict=True))
    return {
        name: min(max(value, quantities[name].low), quantities[name].high) for name, value in values.items()
    }


def _scaled(value: Any, factor: float) -> Any:
    return [_scaled(entry, factor) for entry in value] if isinstance(value, list) else value * factor


def _condition(value: Any, where: str, random: Random) -> Any:
    if not isinstance(value, Mapping):
        return value
    if "one_of" in value:
        return value["one_of"][random.integers(len(value["one_of"]))]
    if set(value) == {"from", "to"}:
        low, high = value["from"], value["to"]
        if low > high:
            raise InputError(f"from {low} to {high} is no range", where, "give the smaller bound first")
        if isinstance(low, int) and isinstance(high, int):
            return int(random.integers(low, high + 1))
        if low > 0:
            return math.exp(random.uniform(math.log(low), math.log(high)))
        return float(random.uniform(low, high))
    return draw_conditions(value, random)


def _around(quantity: Quantity, value: float, around: float, random: Random) -> float:
    """Change a value by a random factor of its distance from neutral; what may go either way does."""
    factor = math.exp(random.uniform(-around, around))
    turned = random.random() < 0.5
    neutral = 0.0 if math.isnan(quantity.neutral) else quantity.neutral
    if neutral == 1.0:
        ratio = 1.0 + factor * (value - 1.0)
        return 1.0 / ratio if turned else ratio
    return -factor * value if turned and quantity.low < 0 else factor * value


def _vectors(quantities: Mapping[str, Quantity]) -> list[list[str]]:
    """Return the quantities that are components of one thing: alike in unit, all but the first zero by default."""
    first, strength = next(iter(quantities.items()))
    others = [
        name
        for name, quantity in quantities.items()
        if name != first and quantity.unit == strength.unit and quantity.default == 0.0
    ]
    return [[first, *others]] if others else []


def _turned(components: list[float], signed: bool, random: Random) -> list[float]:
    """Turn a vector at random; where components cannot be negative, put it along another of them."""
    length = math.hypot(*components)
    direction = random.standard_normal(len(components))
    if signed:
        return list((length * direction / np.linalg.norm(direction)).tolist())
    return [length if place == int(direction.argmax()) else 0.0 for place in range(len(components))]
