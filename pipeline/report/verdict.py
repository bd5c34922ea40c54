"""The verdict in words: the one place where its sentences are made, for the page and for the terminal."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from simgap.effects.told import is_told
from simgap.recordings.contradiction import SUSPECTED
from simgap.report.doubts import doubted, doubts_of, refuted, unfinished
from simgap.report.improvement import sureness, why_unknown
from simgap.report.inputs import ReportInputs
from simgap.report.naming import each_once, rivals, subject_of, with_subject
from simgap.report.section import Drawing, Section
from simgap.report.text import (
    estimate,
    is_number,
    listed,
    minus,
    percent,
    probability,
    short,
    spoken,
    with_unit,
)

LABELS = {
    "missing_physics": "Physics is missing",
    "parameter_mismatch": "Parameters are wrong",
    "none": "Nothing is missing",
    "unexplained": "Unexplained gap",
    "contradiction": "The recording contradicts itself or the platform",
}
BELIEVED = 0.5
"""The probability from which on an effect is stated; below it stands under "perhaps"."""
TIMES_NOISE = 2.0
"""Times the noise, within which what is left is not mentioned."""


@dataclass(frozen=True)
class Named:
    """One effect of the diagnosis in words.

    Attributes:
        name: as the contract writes it.
        words: the same as words, with its subject.
        subject: what the name is about, as words; empty where the name says that.
        facts: its values and its probability.
        statement: what a person can do about it.
    """

    name: str
    words: str
    subject: str
    facts: str
    statement: str


@dataclass(frozen=True)
class Summary:
    """What a diagnosis found, in sentences.

    Attributes:
        verdict: as the contract writes it.
        label: the same in words.
        headline: only what is believed.
        unfinished: that the search was ended before it was complete; empty where it was not.
        closed: how much of the gap that closes, and what is left beside the noise; empty where it says nothing.
        believed: the effects that the headline is about.
        perhaps: those that are less likely than not.
        ambiguous: what cannot be told apart, and what would tell it.
        unnamed: what has no name, with its size in units and as a multiple of the noise.
        contradictions: evidence and remedy of each.
    """

    verdict: str
    label: str
    headline: str
    unfinished: str
    closed: str
    believed: list[Named]
    perhaps: list[Named]
    ambiguous: list[str]
    unnamed: list[str]
    contradictions: list[str]


def summary(diagnosis: dict[str, Any]) -> Summary:
    """Say what a diagnosis (docs/contract.md) found."""
    verdict = diagnosis["verdict"]
    contradicted = verdict == "contradiction"
    believed, doubted = told_apart(diagnosis["effects"])
    return Summary(
        verdict=verdict,
        label=LABELS.get(verdict, spoken(verdict)),
        headline=headline(diagnosis),
        unfinished=unfinished(diagnosis),
        closed="" if contradicted else _closed(diagnosis),
        believed=_named(believed, diagnosis["effects"]),
        perhaps=_named(doubted, diagnosis["effects"]),
        ambiguous=[
            f"{listed(rivals(entry), 'or')}: this recording cannot tell. To tell them apart: "
            f"{_small(entry['separate_by'])}"
            for entry in diagnosis.get("ambiguous") or []
        ],
        unnamed=[]
        if contradicted
        else [_unnamed(entry) for entry in notable(diagnosis.get("unnamed") or [])],
        contradictions=[f"{c['evidence']}. {c['remedy']}" for c in diagnosis.get("contradictions") or []],
    )


def told_apart(effects: Sequence[dict[str, Any]]) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the effects that are believed, and those that are less likely than not."""
    believed = [effect for effect in effects if (effect.get("probability") or 0.0) >= BELIEVED]
    return believed, [effect for effect in effects if effect not in believed]


def notable(unnamed: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return what has no name and is more than twice the noise, or of unknown size."""
    return [entry for entry in unnamed if (times := _times_noise(entry)) is None or times > TIMES_NOISE]


def size_of(entry: dict[str, Any]) -> str:
    """Write the size of what has no name in its unit and as a multiple of the noise."""
    size, times = entry.get("size") or {}, _times_noise(entry)
    if times is None:
        return f"{percent(min(entry['share'], 1.0))} of the residual" if is_number(entry.get("share")) else ""
    return f"{with_unit(short(size['value'], 2), size.get('unit'))}, {short(times, 2)} times the noise"


def headline(diagnosis: dict[str, Any]) -> str:
    """Return the verdict as short sentences that state only what is believed, and what speaks against it."""
    against = (doubted(diagnosis), refuted(diagnosis))
    return " ".join([_answer(diagnosis), *filter(None, against)])


def _answer(diagnosis: dict[str, Any]) -> str:
    """Return the verdict as one or two short sentences."""
    believed, _ = told_apart(diagnosis["effects"])
    wrong = [effect for effect in believed if str(effect["name"]).endswith("_error")]
    missing = [effect for effect in believed if effect not in wrong]
    verdict, facts = diagnosis["verdict"], _believed(missing, wrong)
    if verdict == "contradiction":
        return _contradicted(diagnosis.get("contradictions") or [])
    if verdict == "missing_physics":
        unsure = "physics is missing from the simulator, but no single cause is likelier than not"
        numbers = f"{facts}. Beside that, {unsure}" if facts else f"{unsure[:1].upper()}{unsure[1:]}"
        return f"{facts if missing else numbers}."
    if verdict == "parameter_mismatch":
        return f"No physics is missing. {facts or 'A number of the platform file seems to be wrong'}."
    if verdict == "none":
        return "The simulator fits this recording: nothing is missing that it could show."
    if verdict == "unexplained":
        gap = "a gap remains that no known effect explains"
        return f"{facts}, and {gap}." if facts else f"{gap[:1].upper()}{gap[1:]}."
    return f"The diagnosis says “{spoken(verdict)}”."


def parameters(effect: dict[str, Any]) -> list[str]:
    """Return `name value ± std unit` of each parameter of an effect; of a size that is not told, only its error."""
    told = is_told({"parameters": {}, **effect})
    return [
        f"{_parameter(effect, name)} "
        + (estimate(entry.get("value"), entry.get("std"), entry.get("unit")) if told else _untold(entry))
        for name, entry in (effect.get("parameters") or {}).items()
    ]


def _untold(entry: dict[str, Any]) -> str:
    return f"not told (error {with_unit(short(entry['std'], 2), entry.get('unit'))})"


def verdict_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Say what the diagnosis found, before everything else."""
    diagnosis = inputs.diagnosis
    if diagnosis is None:
        return None
    content = {"summary": summary(diagnosis), "warnings": len(doubts_of(diagnosis))}
    return Section("verdict", "Verdict", content)


def _believed(missing: Sequence[dict[str, Any]], wrong: Sequence[dict[str, Any]]) -> str:
    """Return one sentence without a full stop on what is believed; empty where nothing is."""
    left_out = f"The simulator leaves out {listed(each_once(missing))}" if missing else ""
    numbers = listed(each_once([entry | {"name": entry["name"].removesuffix("_error")} for entry in wrong]))
    mistaken = f"the platform file is wrong about {numbers}" if wrong else ""
    both = f"{left_out}, and {mistaken}" if missing and wrong else left_out or mistaken
    return both[:1].upper() + both[1:]


def _contradicted(contradictions: Sequence[dict[str, Any]]) -> str:
    suspicions = [
        f"{each['column']} ({SUSPECTED.get(each['suspected'], spoken(each['suspected']))})"
        for each in contradictions
    ]
    suspected = f" Suspected: {listed(dict.fromkeys(suspicions))}." if suspicions else ""
    return f"Mend the recording or the platform file first: nothing can be named.{suspected}"


def _named(effects: Sequence[dict[str, Any]], among: Sequence[dict[str, Any]]) -> list[Named]:
    described = []
    for effect in effects:
        name, subject = str(effect["name"]), subject_of(effect, among)
        facts = [*parameters(effect), f"probability {probability(effect.get('probability'))}"]
        statement = minus(str(effect.get("statement") or ""))
        described.append(
            Named(name, with_subject(spoken(name), subject), subject, ", ".join(facts), statement)
        )
    return described


def _unnamed(entry: dict[str, Any]) -> str:
    follows = listed(map(spoken, entry.get("depends_on") or ["no recorded signal"]))
    return f"{spoken(entry['channel'])}: {size_of(entry)}; it follows {follows}"


def _times_noise(entry: dict[str, Any]) -> float | None:
    size = entry.get("size") or {}
    value, noise = size.get("value"), size.get("noise")
    return value / noise if is_number(value) and is_number(noise) and noise > 0 else None


def _parameter(effect: dict[str, Any], name: str) -> str:
    is_ratio = str(effect["name"]).endswith("_error") and len(effect["parameters"]) == 1
    return "true over nominal" if is_ratio else spoken(name)


def _closed(diagnosis: dict[str, Any]) -> str:
    """Say how much of the gap closes, never rounded up to all of it, and how much is left beside the noise."""
    fit = diagnosis.get("fit") or {}
    after, floor = fit.get("after"), fit.get("noise_floor")
    times = after / floor if is_number(after) and is_number(floor) and floor > 0 else None
    if not diagnosis["effects"]:
        return "" if times is None else f"Its error is {short(times, 2)} times the noise."
    left = _left(times, diagnosis) if times is not None and times > TIMES_NOISE else ""
    if not is_number(fit.get("gap_closed")):
        return f"How much of the gap closes is not known: {why_unknown(fit)}.{left}"
    sure = f" ({known})" if (known := sureness(fit)) else ""
    share = percent(fit["gap_closed"])
    return f"The corrected simulator closes {share} of the gap on runs never used for fitting{sure}.{left}"


def _left(times: float, diagnosis: dict[str, Any]) -> str:
    """Say how much is left beside the noise, and that nothing accounts for it where no line does."""
    unknown = (
        ""
        if notable(diagnosis.get("unnamed") or [])
        else "; neither an effect nor a formula of what was recorded accounts for it"
    )
    return f" What is left is {short(times, 2)} times the noise{unknown}."


def _small(sentence: str) -> str:
    return f"{sentence[:1].lower()}{sentence[1:]}"
