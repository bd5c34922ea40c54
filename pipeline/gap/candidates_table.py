"""What became of every candidate that mattered: in or out, how probable, its values, and why."""

from collections.abc import Iterator
from typing import Any

from simgap.gap.candidate import Candidate
from simgap.gap.competition import spoken
from simgap.gap.diagnosis import Diagnosis
from simgap.gap.probability import presence_of
from simgap.simulation import FittedEffect

_MATTERS = 0.1  # of what was left in a channel, and of the noise: what explains less at best is not listed
_MOST = 12  # that are out


def candidates(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return what was named, the most probable first, then what was added and dropped, then what came close.

    Each entry holds `name`, `status` (`in`, `rival`, `dropped` or `out`), `probability` (None where none was worked
    out), `parameters` (value, std, unit by name; of the final fit, or of the best fit of what is out), `share`
    of what was left in a channel that it explained at best, and `why`.
    """
    named = sorted(diagnosis.naming.named, key=lambda c: -diagnosis.probabilities[c.effect.key])
    inside = [_inside(diagnosis, candidate) for candidate in named]
    outside = [_outside(diagnosis, *entry) for entry in _history(diagnosis)]
    order = {"rival": 0, "dropped": 1, "out": 2}
    outside.sort(key=lambda entry: (order[entry["status"]], -entry["share"]))
    return inside + outside[:_MOST]


def _inside(diagnosis: Diagnosis, candidate: Candidate) -> dict[str, Any]:
    fitted = next(f for f in diagnosis.simulator.effects if f.effect.key == candidate.effect.key)
    channel = diagnosis.channels[candidate.channel].name
    why = f"explains {min(candidate.share, 1.0):.0%} of what the other effects leave in {channel}, on runs left out"
    rivalry = next((r for r in diagnosis.naming.rivalries if r.winner.key == candidate.effect.key), None)
    if rivalry:
        why += f"; not told apart from {', '.join(spoken(rival) for rival in rivalry.rivals)}"
    probability = diagnosis.probabilities[candidate.effect.key]
    return _entry(diagnosis, fitted, "in", probability, candidate.share, why)


def _history(diagnosis: Diagnosis) -> Iterator[tuple[Candidate, Candidate, bool]]:
    """Yield each effect that is out and mattered: at its best, when judged last, and whether it was ever added."""
    named = {candidate.effect.key for candidate in diagnosis.naming.named}
    met: dict[str, list[Candidate]] = {}
    added: dict[str, Candidate] = {}
    for turn in diagnosis.naming.rounds:
        for candidate in turn.candidates:
            met.setdefault(candidate.effect.key, []).append(candidate)
        if turn.winner is not None:
            added[turn.winner.effect.key] = turn.winner
    rivals = {rival.key for rivalry in diagnosis.naming.rivalries for rival in rivalry.rivals}
    for key, entries in met.items():
        best = added.get(key) or max(entries, key=lambda candidate: candidate.share)
        if key not in named and (key in added or key in rivals or min(best.share, best.signal) >= _MATTERS):
            yield best, entries[-1], key in added


def _outside(diagnosis: Diagnosis, best: Candidate, last: Candidate, added: bool) -> dict[str, Any]:
    effect = best.effect
    fitted = next(f for f in best.fit.simulator.effects if f.effect.key == effect.key)
    for rivalry in diagnosis.naming.rivalries:
        weights = {rival.key: weight for rival, weight in zip(rivalry.rivals, rivalry.others, strict=False)}
        if effect.key in weights:
            presence = presence_of(diagnosis.features[rivalry.winner.key])
            why = f"could stand in for {spoken(rivalry.winner)}"
            return _entry(diagnosis, fitted, "rival", presence * weights[effect.key], best.share, why)
    if added:
        reason = diagnosis.naming.dropped.get(effect.key) or "another effect predicts better in its place"
        return _entry(diagnosis, fitted, "dropped", None, best.share, f"added, then dropped: {reason}")
    return _entry(diagnosis, fitted, "out", None, best.share, _why_out(diagnosis, last))


def _why_out(diagnosis: Diagnosis, last: Candidate) -> str:
    named = ", ".join(spoken(candidate.effect) for candidate in diagnosis.naming.named)
    beside = f"beside {named}: " if named else ""
    return beside + (last.refusal or f"explains {min(max(last.share, 0.0), 1.0):.0%} of what is left")


def _entry(
    diagnosis: Diagnosis,
    fitted: FittedEffect,
    status: str,
    probability: float | None,
    share: float,
    why: str,
) -> dict[str, Any]:
    units = fitted.effect.units(diagnosis.simulator.position_unit)
    parameters = {
        name: {"value": value, "std": fitted.std.get(name), "unit": units[name]}
        for name, value in fitted.values.items()
    }
    return {
        "name": fitted.effect.key,
        "status": status,
        "probability": probability,
        "parameters": parameters,
        "share": share,
        "why": why,
    }
