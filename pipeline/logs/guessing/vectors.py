"""Signals that are the components of one vector: their names differ in an axis or a number only."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from simgap.logs.guessing.words import words_of

_HOLE = "*"
_COMPASS = {"n": "n", "e": "e", "d": "d", "u": "u", "north": "n", "east": "e", "down": "d", "up": "u"}
_LETTERS = ("v", "p", "a")  # that stand before such an axis in one word: "vn"
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
        down: whether it is named after north, east and down; named after east, north and up, it is x, y and z.
    """

    names: tuple[str, ...]
    axes: str
    letters: str
    context: tuple[str, ...]
    down: bool = False

    @property
    def words(self) -> set[str]:
        """All words of the name but the axis."""
        return {*self.context, self.letters} - {""}


def is_estimated(vector: Vector) -> bool:
    """Whether a name says that the vector is what an on-board estimator believed."""
    return bool(vector.words & _ESTIMATED)


def vectors_of(names: Iterable[str]) -> list[Vector]:
    """Return all vectors in names of signals, those with three axes, four of a quaternion, or four numbers.

    North, east, down and east, north, up are taken in this order as x, y and z.
    """
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
        for order in ("ned", "enu"):
            if axes is None and set(order) <= set(parts):
                names = tuple(parts[axis] for axis in order)
                found.append(Vector(names, "xyz", letters, context, down=order == "ned"))
        if axes == "wxyz":
            found.append(Vector(tuple(parts[axis] for axis in "xyz"), "xyz", letters, context))
    return found


def _holes(name: str) -> Iterable[tuple[tuple[str, ...], str]]:
    words = words_of(re.sub(r"(?<=[a-z])(?=[XYZW](?![a-z]))", "_", name))
    for place, word in enumerate(words):
        if word[-1] in "wxyz" or word in tuple("01234"):
            yield (*words[:place], word[:-1] + _HOLE, *words[place + 1 :]), word[-1]
        elif word in _COMPASS:
            yield (*words[:place], _HOLE, *words[place + 1 :]), _COMPASS[word]
        elif len(word) == 2 and word[0] in _LETTERS and word[1] in _COMPASS:
            yield (*words[:place], word[0] + _HOLE, *words[place + 1 :]), word[1]
