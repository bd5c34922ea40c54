"""What is missing: the effects named, those that cannot be told apart, and what has no name."""

from simgap.report.inputs import ReportInputs
from simgap.report.naming import rivals, subject_of
from simgap.report.section import Drawing, Section
from simgap.report.verdict import notable, parameters, size_of, told_apart


def what_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List effects with their values and what to do, ambiguous ones, and the unnamed remainder."""
    diagnosis = inputs.diagnosis
    if diagnosis is None:
        return None
    believed, doubted = (
        [effect | {"values": parameters(effect), "about": subject_of(effect)} for effect in effects]
        for effects in told_apart(diagnosis["effects"])
    )
    unnamed = [entry | {"size": size_of(entry)} for entry in notable(diagnosis.get("unnamed") or [])]
    content = {
        "believed": believed,
        "doubted": doubted,
        "ambiguous": [entry | {"rivals": rivals(entry)} for entry in diagnosis.get("ambiguous") or []],
        "unnamed": unnamed,
    }
    return Section("what", "What it is", content)
