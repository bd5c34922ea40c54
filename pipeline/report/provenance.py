"""What the result rests on: warnings, and where the recording comes from."""

from typing import Any

from simgap.report.doubts import doubts_of
from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.text import spoken

_PARTS = {"train": "to fit", "validation": "to choose", "holdout": "held out"}


def warnings_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List every doubt about the recording and the diagnosis."""
    warnings = doubts_of(inputs.diagnosis or {})
    return Section("warnings", "Warnings", {"warnings": warnings}) if warnings else None


def provenance_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Say where the recording comes from, under which licence, and how its runs were used."""
    recorded = inputs.recording_facts
    facts = [
        ("Name", inputs.name),
        ("Kind of platform", spoken(recorded.get("platform_kind", ""))),
        ("Source", recorded.get("source", "")),
        ("Licence", recorded.get("licence", "")),
    ]
    content: dict[str, Any] = {"facts": [fact for fact in facts if fact[1]], "parts": _parts(inputs)}
    return Section("provenance", "Where this comes from", content) if any(content.values()) else None


def _parts(inputs: ReportInputs) -> list[dict[str, Any]]:
    held_out = ((inputs.diagnosis or {}).get("fit") or {}).get("held_out_runs") or []
    split = inputs.split or dict.fromkeys(held_out, "holdout")
    parts = [
        {"name": name, "runs": [run for run, part in split.items() if part == key]}
        for key, name in _PARTS.items()
    ]
    return [part for part in parts if part["runs"]]
