"""Doubts about a diagnosis: its warnings, and whether its search came to an end."""

from collections.abc import Iterator
from typing import Any

_UNFINISHED = "the search was ended"
"""How the warning begins that says that the answer is the best so far."""
_REFUTED = "held-out runs refute"
"""How warnings begin that speak against the answer."""
_DOUBTED = "a column may not be what it is taken for"
"""How the warning begins that says why all names are less probable."""


def doubts_of(diagnosis: dict[str, Any]) -> list[str]:
    """Return the warnings of a diagnosis, without what stands beside its headline."""
    contradictions = (str(each["evidence"]) for each in diagnosis.get("contradictions") or [])
    said = (*contradictions, _UNFINISHED, _DOUBTED, _REFUTED)
    return [warning for warning in diagnosis.get("warnings") or [] if not warning.startswith(said)]


def unfinished(diagnosis: dict[str, Any]) -> str:
    """Return the sentence that says that the search was ended before it was complete; empty where it was not."""
    return next(_beginning(_UNFINISHED, diagnosis), "")


def refuted(diagnosis: dict[str, Any]) -> str:
    """Return the sentence that says that held-out runs refute the answer; empty where they do not."""
    return next(_beginning(_REFUTED, diagnosis), "")


def doubted(diagnosis: dict[str, Any]) -> str:
    """Return the sentence that says that a column may be another one than it is taken for; empty where none may."""
    return next(_beginning(_DOUBTED, diagnosis), "")


def _beginning(words: str, diagnosis: dict[str, Any]) -> Iterator[str]:
    """Yield the warnings that begin with these words as sentences."""
    for warning in diagnosis.get("warnings") or []:
        if warning.startswith(words):
            yield f"{warning[:1].upper()}{warning[1:].rstrip('.')}."
