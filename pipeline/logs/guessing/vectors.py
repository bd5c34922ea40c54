"""Signals that are the components of one vector: their names differ in an axis or a number only."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from simgap.logs.guessing.words import words_of

_AXES = {"xyz": "xyz", "wxyz": "wxyz", "1234": "1234", "0123": "0123"}
_HOLE = "*"
_ESTIMATED = frozenset((
    "est", "estimate", "estimated", "estimator", "ekf", "kalman", "state", "stateestimate",
))  # fmt: skip


@dataclass(frozen=True)
class Vector:
    """Signals that differ in one place of their names.

    Attributes:
        names: of the components, in the order of the axes.
        axes: xyz, wxyz, 1234 or 0123.
        letters: what stands before the axis in the same word: "v" of "vx"; empty where nothing does.
        context: the other words.
    """

    names: tuple[str, ...]
    axes: str
    letters: str
    context: tuple[str, ...]

    @property
    def words(self) -> set[str]:
        """All words of the name but the axis."""
        return {*self.context, self.letters} - {""}


def is_estimated(vector: Vector) -> bool:
    """Whether a name says that the vector is what an on-board estimator believed."""
    return bool(vector.words & _ESTIMATED)


def vectors_of(names: Iterable[str]) -> list[Vector]:
    """Return all vectors in names of signals, those with three axes, four of a quaternion, or four numbers."""
    holes: dict[tuple[str, ...], dict[str, str]] = {}
    for name in names:
        for key, axis in _holes(name):
            holes.setdefault(key, {}).setdefault(axis, name)
    found = []
    for key, parts in holes.items():
        place = next(number for number, word in enumerate(key) if _HOLE in word)
        letters, context = key[place].replace(_HOLE, ""), (*key[:place], *key[place + 1 :])
        axes = next((axes for axes in ("wxyz", "1234", "0123", "xyz") if set(axes) <= set(parts)), None)
        if axes:
            found.append(Vector(tuple(parts[axis] for axis in axes), axes, letters, context))
        if axes == "wxyz":
            found.append(Vector(tuple(parts[axis] for axis in "xyz"), "xyz", letters, context))
    return found


def _holes(name: str) -> Iterable[tuple[tuple[str, ...], str]]:
    words = words_of(re.sub(r"(?<=[a-z])(?=[XYZW](?![a-z]))", "_", name))
    for place, word in enumerate(words):
        if word[-1] in "wxyz" or word in tuple("01234"):
            yield (*words[:place], word[:-1] + _HOLE, *words[place + 1 :]), word[-1]
