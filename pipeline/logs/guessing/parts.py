"""Which signals belong to the same joint: those whose names differ only by the quantity."""

from collections.abc import Mapping
from dataclasses import dataclass

from simgap.logs.guessing.words import Said, is_preferred

Part = tuple[str, ...]


@dataclass(frozen=True)
class Named:
    """A signal with what its name says and the part of the machine that it is of.

    Attributes:
        name: of the signal.
        said: by its name.
        part: the words by which it differs from others of its quantity; empty where there is one of it only.
    """

    name: str
    said: Said
    part: Part


def named_signals(said: Mapping[str, Said]) -> list[Named]:
    """Return the signals whose names say a quantity, with the part that each is of."""
    groups: dict[tuple[str, bool], list[str]] = {}
    for name, entry in said.items():
        if entry.quantity and not entry.other:
            groups.setdefault((entry.quantity, entry.commanded), []).append(name)
    found = []
    for names in groups.values():
        common = set.intersection(*(set(said[name].part) for name in names))
        for name in names:
            part = tuple(word for word in said[name].part if word not in common) if len(names) > 1 else ()
            found.append(Named(name, said[name], part))
    return found


def choices(
    named: list[Named], quantity: str, commanded: bool, part: Part, near: frozenset[str] = frozenset()
) -> list[Named]:
    """Return the signals of a quantity that may be of a part, the likeliest first; those of no part serve all.

    Args:
        named: signals with what their names say.
        quantity: that is looked for.
        commanded: whether the commanded one.
        part: of the machine.
        near: words of a name that is of the part for sure; a part that these words name is the same.
    """
    fitting = [each for each in named if each.said.quantity == quantity and each.said.commanded == commanded]
    own = (
        [each for each in fitting if each.part == part]
        or [each for each in fitting if each.part and near.issuperset(each.part)]
        or [each for each in fitting if not each.part]
    )
    return sorted(own, key=lambda each: (-is_preferred(each.said), -each.said.score, len(each.name)))


def parts_of(named: list[Named]) -> list[Part]:
    """Return the parts that have a measured position or, where none has, a velocity."""
    for quantity in ("position", "velocity"):
        parts = [e.part for e in named if e.said.quantity == quantity and not e.said.commanded]
        if parts:
            return list(dict.fromkeys(parts))
    return []
