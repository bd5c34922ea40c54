"""Published recordings with known effects: which were found, and whether a removed effect is named again."""

from collections.abc import Mapping, Sequence
from typing import Any

from simgap.benchmark.flexible import Explained
from simgap.benchmark.score import BELIEVED


def score_published(known: Mapping[str, Any], answer: Mapping[str, Any]) -> dict[str, Any]:
    """Return how much of what is known was found.

    Args:
        known: `effects` that have to be named, each a name or names of which one is enough (`a|b`); `values` of their
            parameters where these are known, as {effect: {parameter: value}}; `source` of what is known.
        answer: of the diagnosis, with its posterior, and the diagnoses of what was taken out as `ablated`.

    Returns:
        `found` and `missed`: of the known effects; `undecided`: those that would be found if the recording could tell
        them from their rivals, with these; `first`: what is named first; `first_known`: whether that is known;
        `explained_enough`: whether the names explain four fifths of what a flexible regression does on held-out runs;
        `errors`: relative errors of known values; `restored`: by effect that was taken out, whether it is named first
        when it is missing.
    """
    diagnosis = answer.get("diagnosis")
    named = [(effect["name"], effect["probability"]) for effect in diagnosis["effects"]] if diagnosis else []
    believed = {name for name, probability in named if probability >= BELIEVED}
    wanted = list(known.get("effects", ()))
    found = [entry for entry in wanted if believed & set(entry.split("|"))]
    rivals = _rivals_of_believed(named, answer)
    undecided = {
        entry: rivals[name]
        for entry in wanted
        for name in entry.split("|")
        if entry not in found and name in rivals
    }
    first = named[0][0] if named else None
    return {
        "found": found,
        "undecided": undecided,
        "missed": [entry for entry in wanted if entry not in found and entry not in undecided],
        "first": first,
        "first_known": any(first in entry.split("|") for entry in wanted),
        "explained_enough": _explained_enough(answer.get("explained")),
        "errors": _errors(known.get("values", {}), diagnosis),
        "restored": {name: _first(again) == name for name, again in answer.get("ablated", {}).items()},
    }


def _explained_enough(explained: Mapping[str, float] | None) -> bool:
    return explained is not None and Explained(**explained).enough


def _rivals_of_believed(
    named: Sequence[tuple[str, float]], answer: Mapping[str, Any]
) -> dict[str, list[str]]:
    """Return the rivals of every name that is believed together with them."""
    posterior = {key.partition("@")[0]: raw for key, raw in (answer.get("posterior") or {}).items()}
    groups = {
        group["names"][0]: group["names"][1:]
        for group in (answer.get("diagnosis") or {}).get("ambiguous", ())
    }
    return {
        name: groups[name]
        for name, probability in named
        if name in groups
        and probability + sum(posterior.get(rival, 0.0) for rival in groups[name]) >= BELIEVED
    }


def published_rows(results: Sequence[Mapping[str, Any]]) -> list[list[str]]:
    """Return a row per recording: what is known, named, closed and explained, what came back, and the seconds."""
    return [_row(result) for result in results]


def _row(result: Mapping[str, Any]) -> list[str]:
    score, diagnosis = result["score"], result.get("diagnosis")
    if diagnosis is None:
        return [
            result["branch"],
            ", ".join(score["missed"]),
            f"failed: {result.get('failed', '')}",
            "–",
            "–",
            "–",
            "–",
        ]
    named = ", ".join(f"`{effect['name']}` {effect['probability']:.2f}" for effect in diagnosis["effects"])
    known = [f"`{entry}` found{_off(score['errors'], entry)}" for entry in score["found"]]
    known += [
        f"`{entry}` found, but not told from {_listed(names)}" for entry, names in score["undecided"].items()
    ]
    known += [f"`{entry}` **missed**" for entry in score["missed"]]
    restored = [f"`{name}` {'back' if back else '**not back**'}" for name, back in score["restored"].items()]
    return [
        result["branch"],
        ", ".join(known),
        named or f"nothing ({diagnosis['verdict']})",
        _closed(diagnosis["fit"]),
        _explained(result.get("explained")),
        ", ".join(restored) or "–",
        f"{result['seconds']:.0f}",
    ]


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _off(errors: Mapping[str, float], entry: str) -> str:
    off = [error for name, error in errors.items() if name.partition(".")[0] in entry.split("|")]
    return f" (off by {max(off):.0%})" if off else ""


def _closed(fit: Mapping[str, Any]) -> str:
    if fit["gap_closed"] is None:
        return "nothing held out"
    if fit["gap_closed_interval"] is None:
        return f"{fit['gap_closed']:.0%} (one run: no interval)"
    low, high = fit["gap_closed_interval"]
    return f"{fit['gap_closed']:.0%} ({low:.0%}–{high:.0%})"


def _explained(explained: Mapping[str, float] | None) -> str:
    return f"{explained['named']:.0%}, {explained['flexible']:.0%}" if explained else "–"


def _errors(
    values: Mapping[str, Mapping[str, float]], diagnosis: Mapping[str, Any] | None
) -> dict[str, float]:
    errors = {}
    for effect in diagnosis["effects"] if diagnosis else ():
        for name, true in values.get(effect["name"], {}).items():
            errors[f"{effect['name']}.{name}"] = abs(effect["parameters"][name]["value"] / true - 1.0)
    return errors


def _first(answer: Mapping[str, Any]) -> str | None:
    effects = answer["diagnosis"]["effects"]
    return effects[0]["name"] if effects else None
