"""How sure: what became of every effect that came close, and, folded away, the explanations that decided it."""

from collections.abc import Mapping, Sequence
from typing import Any

from simgap.report.doubts import unfinished
from simgap.report.inputs import ReportInputs
from simgap.report.naming import key_in_words, subject_of
from simgap.report.section import Drawing, Section
from simgap.report.text import is_number, listed, minus, number, sentence, spoken
from simgap.report.verdict import BELIEVED, parameters

_ANSWERS = {"rival": "cannot be told", "out": "out"}
_PARTS = ("likelihood", "occam", "prior", "score")
"""What the score of a hypothesis is made of, and the score, all in natural logarithms."""
_NO_DIFFERENCE = 0.05
"""Of a score: what would be written as 0.0."""


def sure_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List the candidates with answer and reason, and fold the most probable hypotheses away."""
    diagnosis = inputs.diagnosis or {}
    subjects = {str(effect["name"]): subject_of(effect) for effect in diagnosis.get("effects") or []}
    candidates = [_candidate(entry, subjects) for entry in inputs.evidence("candidates.json") or []]
    weighed = [entry for entry in inputs.evidence("hypotheses.json") or [] if is_number(entry.get("score"))]
    if not (candidates or weighed):
        return None
    content = {
        "unfinished": unfinished(diagnosis),
        "candidates": candidates,
        "explanations": [_explanation(entry, weighed[0], subjects) for entry in weighed],
        "others": max(1.0 - sum(entry["probability"] for entry in weighed), 0.0),
    }
    return Section("sure", "How sure", content)


def points(value: float, best: float) -> str:
    """Write the difference of two logarithms with its sign: `+1.2`, `−35.0`, or 0."""
    difference = value - best
    if abs(difference) < _NO_DIFFERENCE:
        return "0"
    written = f"{difference:.1f}" if abs(difference) < 100.0 else number(difference)
    return minus(written) if difference < 0.0 else f"+{written}"


def _candidate(entry: dict[str, Any], subjects: Mapping[str, str]) -> dict[str, Any]:
    likely = (entry.get("probability") or 0.0) >= BELIEVED
    inside = "in" if likely else "perhaps"
    return entry | {
        "words": key_in_words(entry["name"], subjects),
        "answer": inside if entry["status"] == "in" else _ANSWERS.get(entry["status"], "out"),
        "values": parameters(entry | {"name": entry["name"].partition("@")[0]}),
        "why": sentence(entry["why"]),
    }


def _explanation(entry: dict[str, Any], best: dict[str, Any], subjects: Mapping[str, str]) -> dict[str, Any]:
    """Return a hypothesis in words, and the parts of its score against those of the best one."""
    named, first, small = (
        [key_in_words(key, subjects) for key in keys or []]
        for keys in (entry.get("effects"), best.get("effects"), entry.get("unnamed"))
    )
    return {
        "named": listed(named) if entry is best else _against(named, first),
        "small": listed(small),
        "commands": _commands(entry, subjects),
        "probability": entry["probability"],
        "points": [points(entry[part], best[part]) for part in _PARTS],
    }


def _against(named: Sequence[str], first: Sequence[str]) -> str:
    """Name the effects of a hypothesis by what tells them from those of the best one, where that is shorter."""
    more = [name for name in named if name not in first]
    fewer = [name for name in first if name not in named]
    if len(more) + len(fewer) >= len(named) and named != first:
        return listed(named)
    if more and fewer:
        return f"the same with {listed(more)} in place of {listed(fewer)}"
    return (
        f"the same plus {listed(more)}"
        if more
        else f"the same without {listed(fewer)}"
        if fewer
        else "the same"
    )


def _commands(entry: dict[str, Any], subjects: Mapping[str, str]) -> str:
    """Say how commands act in a hypothesis, what was estimated, and which effects act in a part of the recording."""
    held = "held" if entry.get("held") else "as recorded"
    estimated = [f"{spoken(entry['estimated'])} estimated"] if entry.get("estimated") else []
    partly = [f"{key_in_words(key, subjects)} in a part of the recording" for key in entry.get("runs") or {}]
    return ", ".join([held, *estimated, *partly])
