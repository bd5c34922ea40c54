"""The score of one case: concealed effects against the diagnosis."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from simgap.errors import InputError

BELIEVED = 0.5
"""The probability above which a name counts as an assertion."""

OUTCOMES = ("right", "ambiguous", "wrong", "unnamed", "missed", "failed")
"""The outcomes of a case with a concealed effect; see `outcome_of`."""

_FAILED: dict[str, Any] = {
    "named": [],
    "outcome": "failed",
    "found": 0.0,
    "stated": [],
    "errors": {},
    "runs_right": [],
    "gap_closed": None,
    "verdict": None,
    "verdict_right": False,
    "unnamed": 0,
}


def open_key(path: Path, source: str) -> dict[str, Any]:
    """Open a sealed key whose hash was written into the recording before the diagnosis ran.

    Args:
        path: of the key.
        source: of the recording, which names the hash.

    Raises:
        InputError: when the key is not the one that was sealed.
    """
    text = path.read_text(encoding="utf-8")
    if f"sha256:{hashlib.sha256(text.encode()).hexdigest()}" not in source:
        raise InputError(
            "is not the key that the recording was sealed with", str(path), "record the case again"
        )
    return json.loads(text)


def score_case(
    key: Mapping[str, Any], diagnosis: Mapping[str, Any] | None, wanted: Sequence[str] = ()
) -> dict[str, Any]:
    """Score a diagnosis against its answer key.

    Args:
        key: what was concealed, and in `beside` what is there with it.
        diagnosis: the document; None where the diagnosis failed.
        wanted: what the case is about, where more is concealed because it would not show alone; has to be named.

    Returns:
        `concealed` and `named`: names, the latter with probabilities, most probable first; `outcome`: of `OUTCOMES`, or
        for cases without any effect `right`, `wrong` (an effect is named) or `failed`; `found`: share of the concealed
        effects that are named; `stated`: (probability, whether it is there) of every named effect; `errors`: relative
        errors of parameters, by effect and parameter; `runs_right`: where effects act in some runs only, whether the
        diagnosis lists these, for each that is named; `gap_closed`; `verdict`; `verdict_right`.
    """
    concealed = [effect_name(effect) for effect in key["effects"]]
    there = concealed + [effect_name(effect) for effect in key.get("beside", ())]
    if diagnosis is None:
        return _FAILED | {"concealed": concealed}
    grouped = any("acts_on" in effect for effect in key["effects"])
    named = {effect_name(effect, grouped): effect["probability"] for effect in diagnosis["effects"]}
    found = [named.get(name, 0.0) >= BELIEVED for name in concealed]
    outcome = outcome_of(there, list(named), diagnosis, grouped)
    return {
        "concealed": concealed,
        "named": [[name, probability] for name, probability in named.items()],
        "outcome": "wrong" if outcome == "right" and not set(wanted) <= set(named) else outcome,
        "found": sum(found) / len(found) if found else None,
        "stated": [[probability, name in there] for name, probability in named.items()],
        "errors": parameter_errors(key, diagnosis, grouped),
        "runs_right": runs_right(key, diagnosis, grouped),
        "gap_closed": diagnosis["fit"]["gap_closed"],
        "verdict": diagnosis["verdict"],
        "verdict_right": diagnosis["verdict"] == right_verdict(key),
        "unnamed": len(diagnosis["unnamed"]),
    }


def effect_name(effect: Mapping[str, Any], grouped: bool = True) -> str:
    """Return an effect's name, with its group where keys distinguish groups (`NAME@GROUP`)."""
    return f"{effect['name']}@{effect['acts_on']}" if grouped and "acts_on" in effect else str(effect["name"])


def outcome_of(
    concealed: Sequence[str], named: Sequence[str], diagnosis: Mapping[str, Any], grouped: bool
) -> str:
    """Return the outcome of a case.

    `right`: the first name is concealed (nothing is named where nothing is concealed). `ambiguous`: it is not, but the
    diagnosis lists it with a concealed effect as not to be told apart. `wrong`: it is neither. `unnamed`: no name, but
    the diagnosis says that something is there. `missed`: it says that nothing is.
    """
    if not concealed:
        return "wrong" if named else "right"
    if not named:
        return "unnamed" if diagnosis["verdict"] in ("unexplained", "contradiction") else "missed"
    if named[0] in concealed:
        return "right"
    bare = {name.partition("@")[0] for name in concealed} if grouped else set(concealed)
    first = named[0].partition("@")[0]
    for entry in diagnosis["ambiguous"]:
        if first in entry["names"] and bare & set(entry["names"]):
            return "ambiguous"
    return "wrong"


def right_verdict(key: Mapping[str, Any]) -> str:
    """Return the right verdict of a case."""
    names = [effect["name"] for effect in key["effects"]]
    if any(not name.endswith("_error") for name in names):
        return "missing_physics"
    if key.get("outside"):
        return "unexplained"
    return "parameter_mismatch" if names else "none"


def runs_right(key: Mapping[str, Any], diagnosis: Mapping[str, Any], grouped: bool) -> list[bool]:
    """Return of each concealed effect that is named whether the diagnosis lists the runs in which it acts.

    Empty where all effects act in all runs.
    """
    acts = key.get("acts_in_runs")
    concealed = {effect_name(effect) for effect in key["effects"]}
    named = [effect for effect in diagnosis["effects"] if effect_name(effect, grouped) in concealed]
    return [effect.get("runs") == acts for effect in named] if acts else []


def parameter_errors(
    key: Mapping[str, Any], diagnosis: Mapping[str, Any], grouped: bool
) -> dict[str, dict[str, float]]:
    """Return relative errors of the concealed effects that were named, by effect and parameter.

    Components of one thing (`wind_x`, `wind_y`) count together under what their names share. An error is relative to
    the distance from the value at which the effect would be absent. The strength of an effect comes first, as in the
    diagnosis.
    """
    found = {effect_name(effect, grouped): effect["parameters"] for effect in diagnosis["effects"]}
    errors = {}
    for effect in key["effects"]:
        name = effect_name(effect)
        if name in found:
            errors[name] = _errors(effect["parameters"], found[name], neutral=_neutral(effect["name"]))
    return errors


def _neutral(name: str) -> float:
    return 1.0 if name.endswith("_error") else 0.0


def _errors(
    true: Mapping[str, Mapping[str, Any]], found: Mapping[str, Mapping[str, Any]], neutral: float
) -> dict[str, float]:
    groups: dict[str, list[str]] = {}
    for name in found:
        if name in true and found[name]["value"] is not None:
            groups.setdefault(_stem(name, true), []).append(name)
    errors = {}
    for stem, names in groups.items():
        miss = math.hypot(*(found[name]["value"] - true[name]["value"] for name in names))
        size = math.hypot(*(true[name]["value"] - neutral for name in names))
        if size > 0:
            errors[stem] = miss / size
    return errors


def _stem(name: str, names: Mapping[str, Any]) -> str:
    """Return what a component's name shares with the others; the name itself where it is no component."""
    stem, _, component = name.rpartition("_")
    alone = not stem or component not in {"x", "y", "z", "1", "2", "3", "4"}
    return name if alone or sum(other.rpartition("_")[0] == stem for other in names) < 2 else stem
