"""How to go on: where the simulator is, how to use it, and what to record next."""

import json
import re
from collections.abc import Iterator
from typing import Any

from markupsafe import Markup, escape

from simgap.effects import effects_of, kinds
from simgap.effects.told import is_told
from simgap.report.inputs import ReportInputs
from simgap.report.naming import rivals
from simgap.report.section import Drawing, Section
from simgap.report.text import listed, spoken
from simgap.report.verdict import notable, told_apart

_RECORD = re.compile(r"\brecord (?:more|ten|longer|again|runs)\b", re.IGNORECASE)


def use_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Say where the simulator is, how to use it in Python, and what to record next."""
    diagnosis = inputs.diagnosis
    if diagnosis is None:
        return None
    kind = str(inputs.recording_facts.get("platform_kind") or "")
    content = {
        "simulator": inputs.simulator,
        "snippet": Markup(escape(snippet(inputs.simulator))),  # as it is: no minus sign of print in a path
        "effects": len(diagnosis["effects"]),
        "contradicted": diagnosis["verdict"] == "contradiction",
        "next": list(dict.fromkeys(next_recordings(diagnosis, kind))),
    }
    return Section("use", "Use the answer", content)


def snippet(simulator: str) -> str:
    """Return a program that loads a simulator of any kind and drives it, as it stands."""
    return f"""\
import numpy as np
import simgap

machine = simgap.load_simulator({json.dumps(simulator, ensure_ascii=False)})
state = machine.state()  # at rest; machine.state_names says what its entries are
command = np.zeros(len(machine.command_names))  # machine.command_names likewise
state = machine.step(state, command, dt=0.01)
states = machine.rollout(state, np.tile(command, (200, 1)), dt=0.01)  # (steps + 1, n)"""


def next_recordings(diagnosis: dict[str, Any], kind: str) -> Iterator[str]:
    """Yield what to record next, the most urgent first.

    Args:
        diagnosis: as docs/contract.md says.
        kind: of platform, whose catalogue holds the manoeuvre that shows each effect; any text where it is not known.
    """
    for contradiction in diagnosis.get("contradictions") or []:
        yield f"{contradiction['remedy']} Then diagnose again."
    if not (diagnosis.get("fit") or {}).get("held_out_runs"):
        yield "Record at least two runs, and each sort of motion twice: what is held out then proves the result."
    for entry in diagnosis.get("ambiguous") or []:
        yield f"To tell {listed(rivals(entry), 'and')} apart: {entry['separate_by']}"
    shown_by = {effect.name: effect.excitation for effect in effects_of(kind)} if kind in kinds() else {}
    believed, doubted = told_apart(diagnosis["effects"])
    for effect in believed:
        if effect["name"] in shown_by and not is_told(effect):
            yield f"To learn the size of {spoken(effect['name'])}: {shown_by[effect['name']]}."
    for effect in doubted:
        if effect["name"] in shown_by:
            yield f"To decide about {spoken(effect['name'])}: {shown_by[effect['name']]}."
    for entry in notable(diagnosis.get("unnamed") or []) if not diagnosis.get("contradictions") else []:
        if entry.get("depends_on"):
            signals = listed(map(spoken, entry["depends_on"]))
            yield f"To learn what acts on {spoken(entry['channel'])}: vary {signals} over a wide range, one at a time."
    yield from (warning for warning in diagnosis.get("warnings") or [] if _RECORD.search(warning))
