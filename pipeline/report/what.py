"""What is missing: the effects named, those that cannot be told apart, and what has no name."""

from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.verdict import parameters


def what_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List effects with their values and what to do, ambiguous ones, and the unnamed remainder."""
    diagnosis = inputs.diagnosis
    if diagnosis is None:
        return None
    effects = [effect | {"values": parameters(effect)} for effect in diagnosis["effects"]]
    content = {
        "effects": effects,
        "ambiguous": diagnosis.get("ambiguous") or [],
        "unnamed": diagnosis.get("unnamed") or [],
    }
    return Section("what", "What it is", content)
