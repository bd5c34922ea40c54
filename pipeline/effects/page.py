"""The catalogue as a page of the documentation, in Markdown."""

import re
from collections.abc import Iterable, Sequence

from simgap.effects.catalogue import effects_of, kinds
from simgap.effects.effect import Effect
from simgap.effects.listing import facts, meaning, shown_parameters

_HEAD = """\
# Effects

The physics that a simulator may lack and a diagnosis can name. This page is made from the catalogue by
`simgap effects --write docs/effects.md`.

An effect acts in one place on the way from command to measurement, or it corrects a number of the platform; in a swerve
drive, its place is the group that it acts on. On a joint that slides, N·m is N and rad is m. A parameter has a default
of a realistic size, bounds, and a neutral value at which the effect does nothing.
"""


def catalogue_page() -> str:
    """Return the page: of each kind a table of its effects, then each effect in full."""
    return "\n".join([_HEAD, *(_kind(kind) for kind in kinds())])


def _kind(kind: str) -> str:
    effects = effects_of(kind)
    rows = [
        (f"[`{e.key}`](#{_anchor(e)})", e.acts_on, "<br>".join(shown_parameters(e)), meaning(e))
        for e in effects
    ]
    table = _table(("effect", "acts on", "parameters", "what it is"), rows)
    return "\n".join([f"## {kind}\n", table, *(_section(effect) for effect in effects)])


def _section(effect: Effect) -> str:
    numbers = [
        (f"`{p.name}`", p.unit, *(f"{value:g}" for value in (p.default, p.low, p.high, p.neutral)))
        for p in effect.parameters
    ]
    table = _table(("parameter", "unit", "default", "from", "to", "neutral"), numbers)
    listed = [f"- {name}: {_literal(name, text)}" for name, text in facts(effect)]
    return "\n".join([f"### {_title(effect)}\n", f"{meaning(effect)}\n", table, *listed, ""])


def _literal(name: str, text: str) -> str:
    return f"`{text}`" if name == "Formula" else text


def _title(effect: Effect) -> str:
    return f"{effect.kind} {effect.key}"


def _anchor(effect: Effect) -> str:
    """Return the address that the title of a section has where the page is shown."""
    return re.sub(r"[^\w -]", "", _title(effect)).replace(" ", "-")


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"
