"""Concealable effects of joints and swerve drives: their quantities and the answer key."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from simgap.errors import InputError

KEY_SCHEMA = "simgap.key/1"


Size = Mapping[str, float]
"""What is typical of a machine at work: its effort, velocity and so on, by name."""


@dataclass(frozen=True)
class Quantity:
    """A number of a concealed effect.

    Attributes:
        unit: as the key states it.
        default: a clear strength, in units of the machine's own sizes (see `powers`).
        powers: of the machine's own sizes (its effort, velocity, ...) that the default is multiplied by.
        neutral: the value at which the effect is absent; infinite for a limit.
        low: the least value that makes sense.
        high: the greatest.
    """

    unit: str
    default: float
    powers: Mapping[str, int] = field(default_factory=dict)
    neutral: float = 0.0
    low: float = 0.0
    high: float = math.inf

    def typical(self, size: Size) -> float:
        """Return the default for a machine of a size."""
        return self.default * math.prod(size[name] ** power for name, power in self.powers.items())

    def scaled(self, value: float, factor: float) -> float:
        """Return a value that many times as far from neutral, within the bounds."""
        moved = value / factor if math.isinf(self.neutral) else self.neutral + factor * (value - self.neutral)
        return min(max(moved, self.low), self.high)


Table = Mapping[str, Mapping[str, Quantity]]
"""Quantities by effect; the first of each is its strength, with the other components of the same thing."""

Chosen = Mapping[str, Mapping[str, float]]
"""Values by effect and quantity, as a case gives them; what is left out has its default."""


class Concealed:
    """The values of what a case conceals; anything else is neutral."""

    def __init__(self, chosen: Chosen, table: Table, size: Size) -> None:
        """Fill in the defaults of a machine of that size."""
        self.table = table
        self.values = {
            name: {
                key: float(given[key]) if key in given else quantity.typical(size)
                for key, quantity in table[name].items()
            }
            for name, given in chosen.items()
        }

    def __contains__(self, name: str) -> bool:
        return name in self.values

    def get(self, name: str, quantity: str) -> float:
        """Return a quantity of an effect, neutral where the effect is not concealed."""
        return self.values[name][quantity] if name in self.values else self.table[name][quantity].neutral

    def group(self, group: str) -> "Concealed":
        """Return what acts on a group, by names without the group."""
        names = {name: name.partition("@")[0] for name in self.table if name.partition("@")[2] == group}
        table = {bare: self.table[name] for name, bare in names.items()}
        values = {bare: self.values[name] for name, bare in names.items() if name in self.values}
        return Concealed(values, table, {})

    def present(self) -> dict[str, dict[str, float]]:
        """Return the effects whose strength is not neutral, in the order of the table."""
        return {
            name: self.values[name]
            for name, quantities in self.table.items()
            if name in self.values and _acts(self.values[name], quantities)
        }


def _acts(values: Mapping[str, float], quantities: Mapping[str, Quantity]) -> bool:
    """Whether the strength, or another component of it in the same unit, is not neutral."""
    unit = next(iter(quantities.values())).unit
    return any(values[key] != entry.neutral for key, entry in quantities.items() if entry.unit == unit)


def typical(name: str, table: Table, size: Size) -> dict[str, float]:
    """Return the default values of an effect on a machine."""
    return {key: quantity.typical(size) for key, quantity in table[name].items()}


def components(quantities: Mapping[str, Quantity]) -> list[str]:
    """Return the quantities that are the strength of an effect: the first, and what is another component of it."""
    first = next(iter(quantities.values()))
    return [
        name
        for name, quantity in quantities.items()
        if quantity is first or (quantity.unit == first.unit and (quantity.default == 0.0 or quantity.powers))
    ]


def check_chosen(chosen: Chosen, table: Table, where: str) -> None:
    """Refuse effects and quantities that the plant does not have.

    Raises:
        InputError: naming the key.
    """
    for name, given in chosen.items():
        if name not in table:
            raise InputError(f"unknown effect {name!r}", where, _nearest(name, table))
        if not isinstance(given, Mapping):
            raise InputError(
                f"a mapping of quantities is needed, not {given!r}", f"{where}.{name}", "give {}"
            )
        for key, value in given.items():
            if key not in table[name]:
                raise InputError(f"unknown quantity {key!r}", f"{where}.{name}", _nearest(key, table[name]))
            quantity = table[name][key]
            if not (quantity.low <= value <= quantity.high):
                span = f"must be from {quantity.low:g} to {quantity.high:g}, is {value}"
                raise InputError(span, f"{where}.{name}.{key}", "correct it")


def _nearest(name: str, known: Mapping[str, Any]) -> str:
    near = difflib.get_close_matches(str(name), known, n=1, cutoff=0.5)
    return f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"


def entry(name: str, values: Mapping[str, float], units: Mapping[str, str]) -> dict[str, Any]:
    """Return an effect as the key lists it; the group after `@` becomes `acts_on`."""
    bare, _, group = name.partition("@")
    parameters = {key: {"value": float(value), "unit": units[key]} for key, value in values.items()}
    return {"name": bare, "parameters": parameters} | ({"acts_on": group} if group else {})
