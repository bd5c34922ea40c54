"""The verdict in one sentence, and the figures behind it."""

from collections.abc import Sequence
from typing import Any

from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.text import (
    estimate,
    interval,
    is_number,
    listed,
    number,
    percent,
    probability,
    quantity,
    spoken,
)

LABELS = {
    "missing_physics": "Physics is missing",
    "parameter_mismatch": "Parameters are wrong",
    "none": "Nothing is missing",
    "unexplained": "Unexplained gap",
}
_NAMED_IN_SENTENCE = 3


def verdict_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Say in one sentence what the diagnosis found."""
    diagnosis = inputs.diagnosis
    if diagnosis is None:
        return None
    verdict = diagnosis["verdict"]
    content = {
        "verdict": verdict,
        "label": LABELS.get(verdict, spoken(verdict)),
        "sentence": sentence(diagnosis),
        "warnings": len(diagnosis.get("warnings") or []),
    }
    return Section("verdict", "Verdict", content)


def sentence(diagnosis: dict[str, Any]) -> str:
    """Return the verdict as one sentence with effects, values, probabilities and the gap closed."""
    write = {
        "missing_physics": _missing_physics,
        "parameter_mismatch": _parameter_mismatch,
        "none": _none,
        "unexplained": _unexplained,
    }.get(diagnosis["verdict"])
    return write(diagnosis) if write else f"The diagnosis says “{spoken(diagnosis['verdict'])}”."


def parameters(effect: dict[str, Any]) -> list[str]:
    """Return `name value ± std unit` of each parameter of an effect."""
    return [
        f"{_parameter(effect, name)} {estimate(entry.get('value'), entry.get('std'), entry.get('unit'))}"
        for name, entry in (effect.get("parameters") or {}).items()
    ]


def why_unknown(fit: dict[str, Any]) -> str:
    """Say why the share of the gap closed is not given."""
    held_out = fit.get("held_out_runs")
    return "the error is too close to its floor to measure it" if held_out else "no run could be held out"


def _parameter(effect: dict[str, Any], name: str) -> str:
    is_ratio = str(effect["name"]).endswith("_error") and len(effect["parameters"]) == 1
    return "true over nominal" if is_ratio else spoken(name)


def _missing_physics(diagnosis: dict[str, Any]) -> str:
    corrections = [effect for effect in diagnosis["effects"] if str(effect["name"]).endswith("_error")]
    missing = [effect for effect in diagnosis["effects"] if effect not in corrections]
    text = f"The simulator leaves out {_named(missing)}"
    if corrections:
        text += f", and its nominal parameters need correcting: {_named(corrections)}"
    return f"{text}; with that, {_closed(diagnosis)}."


def _parameter_mismatch(diagnosis: dict[str, Any]) -> str:
    named = _named(diagnosis["effects"])
    return (
        f"No physics is missing, but nominal parameters are wrong: {named}; corrected, {_closed(diagnosis)}."
    )


def _none(diagnosis: dict[str, Any]) -> str:
    fit = diagnosis.get("fit") or {}
    text = "Nothing is missing that this recording could show: the simulator fits it down to its noise floor"
    if is_number(fit.get("before")) and is_number(fit.get("noise_floor")):
        text += f" (error {number(fit['before'])} against a floor of {number(fit['noise_floor'])})"
    return f"{text}."


def _unexplained(diagnosis: dict[str, Any]) -> str:
    remainder = [
        f"{percent(entry.get('share'))} of the residual of {quantity(entry['channel'], None)}"
        f" follows {listed(spoken(name) for name in entry.get('depends_on') or ['no recorded signal'])}"
        for entry in diagnosis.get("unnamed") or []
    ]
    text = "A significant gap remains that no effect of the catalogue accounts for"
    if remainder:
        text += f": {listed(remainder[:_NAMED_IN_SENTENCE])}"
    if diagnosis["effects"]:
        text += f"; what could be named is {_named(diagnosis['effects'])}, and with that"
        return f"{text} {_closed(diagnosis)}."
    return f"{text}; {_closed(diagnosis)}."


def _named(effects: Sequence[dict[str, Any]]) -> str:
    """Name effects with their values and probabilities."""
    names = [effect["name"] for effect in effects]
    described = []
    for effect in effects[:_NAMED_IN_SENTENCE]:
        # An effect that acts on two groups of a swerve drive is two entries of one name.
        place = f" ({spoken(effect['acts_on'])})" if names.count(effect["name"]) > 1 else ""
        facts = [*parameters(effect), f"probability {probability(effect.get('probability'))}"]
        described.append(f"{spoken(effect['name'])}{place} ({', '.join(facts)})")
    if more := len(effects) - len(described):
        described.append(f"{more} more")
    return listed(described) if described else "an effect that it does not name"


def _closed(diagnosis: dict[str, Any]) -> str:
    fit = diagnosis.get("fit") or {}
    if not is_number(fit.get("gap_closed")):
        return f"how much of the gap closes is not known, because {why_unknown(fit)}"
    bounds = interval(fit.get("gap_closed_interval"))
    held_out = "on runs never used for fitting"
    return f"{percent(fit['gap_closed'])} of the gap closes {held_out}" + (
        f" (95{chr(0x202F)}% interval {bounds})" if bounds else ""
    )
