"""What may have been done to a recording: pure functions that undo it, each with its name, its odds and its remedy."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from simgap.consistency.samples import Samples

Mend = Callable[[Samples], Mapping[str, np.ndarray]]
"""Returns the columns as they should be."""


@dataclass(frozen=True)
class Transformation:
    """One way in which columns come to be wrong.

    Attributes:
        suspected: a key of `SUSPECTED`.
        column: or group of columns, as it is named.
        columns: that it touches.
        odds: that a recording which contradicts itself does so for this reason.
        mend: what undoes it.
        remedy: the line of a mapping that undoes it, or a sentence.
        words: what was done to the column, where the name of the cause leaves it open.
        needs: other columns that undoing it takes.
    """

    suspected: str
    column: str
    columns: tuple[str, ...]
    odds: float
    mend: Mend
    remedy: str
    words: str = ""
    needs: tuple[str, ...] = ()

    def undo(self, samples: Samples) -> Samples:
        """Return the samples as they were before."""
        return samples.having(self.mend(samples))


def scaled(
    suspected: str,
    column: str,
    columns: tuple[str, ...],
    factor: float,
    odds: float,
    key: str,
    words: str = "",
) -> Transformation:
    """Return the transformation that multiplied columns by a factor.

    Args:
        suspected: a key of `SUSPECTED`.
        column: as it is named.
        columns: that it touches.
        factor: recorded over true.
        odds: see `Transformation`.
        key: what the mapping has to say, such as `unit: deg`.
        words: see `Transformation`.
    """

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        return {name: samples[name] / factor for name in columns}

    return Transformation(suspected, column, columns, odds, mend, mapping(columns, key), words)


def mapping(columns: tuple[str, ...], key: str) -> str:
    """Return the lines of a mapping that say the same of each column."""
    return lines({name: f"from: {name}, {key}" for name in columns})


def renamed(columns: Mapping[str, str]) -> str:
    """Return the lines of a mapping that take columns from others; a minus before a name turns its sign."""
    signs = {name: ", sign: -1" if source.startswith("-") else "" for name, source in columns.items()}
    return lines({name: f"from: {source.lstrip('-')}{signs[name]}" for name, source in columns.items()})


def lines(entries: Mapping[str, str]) -> str:
    """Return what a mapping has to say of each column, in one sentence."""
    each = ", a line each" if len(entries) > 1 else ""
    said = "; ".join(f"{name}: {{{entry}}}" for name, entry in entries.items())
    return f"Say in the mapping{each}: {said}."


def taken(
    suspected: str, column: str, sources: Mapping[str, str], odds: float, words: str = ""
) -> Transformation:
    """Return the transformation that exchanged columns or their signs.

    Args:
        suspected: a key of `SUSPECTED`.
        column: as it is named.
        sources: for each column, the one that holds what belongs there, with a minus where its sign is turned.
        odds: see `Transformation`.
        words: see `Transformation`.
    """
    changed = {name: source for name, source in sources.items() if name != source}

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        return {
            name: -samples[source[1:]] if source.startswith("-") else samples[source]
            for name, source in changed.items()
        }

    return Transformation(suspected, column, tuple(changed), odds, mend, renamed(changed), words)
