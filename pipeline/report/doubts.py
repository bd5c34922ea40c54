"""Doubts about a diagnosis: its warnings, and whether its search came to an end."""

from typing import Any

_UNFINISHED = "the search was ended"
"""How the warning begins that says that the answer is the best so far."""


def doubts_of(diagnosis: dict[str, Any]) -> list[str]:
    """Return the warnings of a diagnosis, without what stands beside its headline."""
    contradictions = (str(each["evidence"]) for each in diagnosis.get("contradictions") or [])
    said = (*contradictions, _UNFINISHED)
    return [warning for warning in diagnosis.get("warnings") or [] if not warning.startswith(said)]


def unfinished(diagnosis: dict[str, Any]) -> str:
    """Return the sentence that says that the search was ended before it was complete; empty where it was not."""
    for warning in diagnosis.get("warnings") or []:
        if warning.startswith(_UNFINISHED):
            return f"{warning[:1].upper()}{warning[1:]}."
    return ""
