"""Cases of the concealed benchmark. The n-th case of a seed does not depend on the number of cases."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

CATEGORIES = ("clear", "faint", "nothing", "decoy", "pair", "hidden", "ambiguous", "outside", "mixed")


@dataclass(frozen=True)
class Subject:
    """Subject of one case.

    Attributes:
        category: one of `CATEGORIES`.
        names: of what is concealed; empty where nothing is.
        strength: `clear` or `faint`; empty where nothing is concealed.
        condition: number of the recording conditions in the table's list, for `hidden` and `ambiguous` cases.
    """

    category: str
    names: tuple[str, ...] = ()
    strength: str = ""
    condition: int = 0


def subjects(table: Mapping[str, Any], shares: Mapping[str, float], seed: int) -> Iterator[Subject]:
    """Yield the subjects of a benchmark without end.

    The category that lags most behind its share comes next; within a category, what there is comes in random order,
    each once before any comes again.

    Args:
        table: of a kind (`conf/prove`).
        shares: by category.
        seed: of the order.
    """
    random = np.random.default_rng([seed, len(CATEGORIES)])
    wanted = {category: shares.get(category, 0.0) for category in CATEGORIES}
    cards = {category: _cards(category, table) for category in CATEGORIES if wanted[category] > 0}
    seeds = dict(zip(cards, random.integers(2**32, size=len(cards)).tolist(), strict=True))
    decks = {category: _shuffled(deck, seeds[category]) for category, deck in cards.items() if deck}
    total = sum(wanted[category] for category in decks)
    dealt = dict.fromkeys(decks, 0)
    number = 0
    while decks:
        number += 1
        category = max(decks, key=lambda entry: wanted[entry] / total * number - dealt[entry])
        dealt[category] += 1
        yield next(decks[category])


def _shuffled(cards: list[Subject], seed: int) -> Iterator[Subject]:
    random = np.random.default_rng(seed)
    while True:
        for place in random.permutation(len(cards)):
            yield cards[place]


def _cards(category: str, table: Mapping[str, Any]) -> list[Subject]:
    """Return what there is of a category; an effect with a twin, which explains the very same, is `ambiguous` only."""
    effects = [name for name, entry in table["effects"].items() if "twin" not in entry]
    physics = [name for name in effects if not name.partition("@")[0].endswith("_error")]
    errors = [name for name in effects if name not in physics]
    if category == "nothing":
        return [Subject("nothing")]
    if category in ("clear", "faint"):
        return [Subject(category, (name,), category) for name in physics]
    if category == "decoy":
        return [Subject("decoy", (name,), strength) for name in errors for strength in ("clear", "faint")]
    if category == "pair":
        apart = {frozenset(pair) for pair in table.get("apart", ())}
        names = [(a, b) for i, a in enumerate(effects) for b in effects[i + 1 :]]
        return [Subject("pair", pair, "clear") for pair in names if frozenset(pair) not in apart]
    if category == "outside":
        return [Subject("outside", (name,), "clear") for name in table.get("outside", {})]
    if category == "mixed":
        return [
            Subject("mixed", (name, other), "clear") for name in effects for other in table.get("outside", {})
        ]
    return [
        Subject(category, (entry["effect"],), "clear", number)
        for number, entry in enumerate(table.get(category, ()))
    ]
