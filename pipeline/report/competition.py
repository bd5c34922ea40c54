"""How sure: what became of every candidate that mattered, and, folded away, the search that decided it."""

from typing import Any

from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.text import is_number, percent, sentence, spoken
from simgap.report.verdict import BELIEVED, parameters

_STATUS = {"rival": "cannot be told", "dropped": "out", "out": "out"}


def competition_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List the candidates, in or out, and fold the steps of the search away."""
    competition = inputs.evidence("competition.json") or {}
    candidates = [_candidate(entry) for entry in inputs.evidence("candidates.json") or []]
    steps = [_step(entry) for entry in competition.get("steps") or []]
    if not (candidates or steps):
        return None
    content = {"candidates": candidates, "steps": steps, "metric": competition.get("metric") or ""}
    return Section("competition", "How sure", content)


def bounded(share: object) -> str:
    """Write a share between none and all of it: what lies outside is the noise of the estimate."""
    return percent(min(max(share, 0.0), 1.0)) if is_number(share) else ""


def _candidate(entry: dict[str, Any]) -> dict[str, Any]:
    likely = (entry.get("probability") or 0.0) >= BELIEVED
    status = (
        ("in" if likely else "perhaps") if entry["status"] == "in" else _STATUS.get(entry["status"], "out")
    )
    return entry | {"said": status, "values": parameters(entry), "why": sentence(entry["why"])}


def _step(entry: dict[str, Any]) -> dict[str, Any]:
    candidates = sorted(
        entry.get("candidates") or [],
        key=lambda candidate: (
            not candidate.get("chosen"),
            -candidate["gain"] if is_number(candidate.get("gain")) else 1e300,
        ),
    )
    chosen = next((candidate["name"] for candidate in candidates if candidate.get("chosen")), None)
    outcome = f"{spoken(chosen)} is added" if chosen else "nothing is added"
    return {"step": entry["step"], "outcome": outcome, "candidates": candidates}
