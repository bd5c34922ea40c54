"""What a diagnosis says in the terminal: the sentences of the page, as plain lines."""

from collections.abc import Iterator, Sequence
from typing import Any

from simgap.report.doubts import doubts_of
from simgap.report.naming import with_subject
from simgap.report.text import NARROW_SPACE, NO_BREAK, minus
from simgap.report.verdict import Named, summary


def terminal_lines(diagnosis: dict[str, Any]) -> list[str]:
    """Return a diagnosis (docs/contract.md) as lines; the first holds the verdict as the contract writes it."""
    return [_plain(line) for line in _lines(diagnosis)]


def warning_lines(diagnosis: dict[str, Any]) -> list[str]:
    """Return the warnings of a diagnosis that `terminal_lines` does not hold, as lines."""
    return [_plain(warning) for warning in doubts_of(diagnosis)]


def _plain(line: str) -> str:
    """Return a line without the narrow spaces of print."""
    return minus(line).replace(f"{NARROW_SPACE}%", "%").replace(NARROW_SPACE, " ").replace(NO_BREAK, " ")


def _lines(diagnosis: dict[str, Any]) -> Iterator[str]:
    said = summary(diagnosis)
    yield f"verdict: {said.verdict}"
    yield said.headline
    if said.unfinished:
        yield said.unfinished
    yield from (f"  {contradiction}" for contradiction in said.contradictions)
    yield from _effects(said.believed)
    yield from (["perhaps:", *_effects(said.perhaps)] if said.perhaps else [])
    yield from (f"not told apart: {rivals}" for rivals in said.ambiguous)
    yield from (f"without a name: {rest}" for rest in said.unnamed)
    if said.closed:
        yield said.closed


def _effects(effects: Sequence[Named]) -> Iterator[str]:
    for effect in effects:
        yield f"  {with_subject(effect.name, effect.subject)}: {effect.facts}"
        yield f"    {effect.statement}"
