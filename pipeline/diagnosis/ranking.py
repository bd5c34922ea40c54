"""How sure: what became of every effect that was considered, and the hypotheses that decided it."""

from typing import Any

from simgap.diagnosis.diagnose import Diagnosis
from simgap.equations.presence import Presence
from simgap.equations.trend import Trend
from simgap.gap.hypothesis import Hypothesis
from simgap.simulation import FittedEffect

_NOTED = 0.02
"""Least probability of an effect that is listed although it is not named."""
_MOST = 12
"""Most entries of either list."""


def candidates(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return what was named, the most probable first, then what came close.

    Each entry holds `name`, `status` (`in`, `rival` or `out`), `probability`, `parameters` (value, std, unit by name;
    of the best hypothesis that names it) and `why`.
    """
    naming = diagnosis.naming
    named = {entry.effect.key: entry for entry in naming.named}
    rivals = {rival.key: r.winner.name for r in naming.rivalries for rival in r.rivals}
    fitted = {f.effect.key: f for f in diagnosis.simulator.effects}
    found = []
    for key, probability in naming.probabilities.items():
        best = naming.posterior.best_with(key)
        alone = next(f for f in best.fit.simulator.free if f.effect.key == key)
        if key in named:
            channel = diagnosis.channels[named[key].channel].name
            why = f"explains {named[key].share:.0%} of the error in {channel} beside the other effects"
            found.append(_entry(diagnosis, fitted.get(key, alone), "in", probability, why))
        elif key in rivals:
            why = f"could stand in for {_spoken(rivals[key])}"
            found.append(_entry(diagnosis, alone, "rival", probability, why))
        elif probability >= _NOTED:
            found.append(_entry(diagnosis, alone, "out", probability, _why_out(naming.posterior.best, best)))
    return sorted(found, key=lambda entry: entry["status"] != "in")[:_MOST]


def hypotheses(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return the most probable hypotheses: what they name, how commands act, and what their score is made of."""
    posterior = diagnosis.naming.posterior
    return [
        {
            "effects": sorted(hypothesis.names),
            "unnamed": sorted(hypothesis.keys - hypothesis.names),
            "held": hypothesis.reading.held,
            "estimated": hypothesis.reading.driver or None,
            "runs": _runs(hypothesis.reading.presence),
            "probability": weight,
            "score": hypothesis.score,
            "likelihood": hypothesis.likelihood.value,
            "occam": hypothesis.occam,
            "prior": hypothesis.prior,
        }
        for hypothesis, weight in list(zip(posterior.hypotheses, posterior.weights, strict=True))[:_MOST]
    ]


def _runs(presence: Presence | Trend | None) -> dict[str, list[Any]] | None:
    """Return where the effects of a hypothesis act that are there in a part of the recording, by their keys."""
    return dict.fromkeys(presence.keys, presence.entries) if isinstance(presence, Presence) else None


def _why_out(best: Hypothesis, other: Hypothesis) -> str:
    behind = best.score - other.score
    if behind <= 0.0:
        return "as probable as the best answer"
    parts = {
        "explains less": best.likelihood.value - other.likelihood.value,
        "needs more parameters than it earns": best.occam - other.occam,
        "is rarer": best.prior - other.prior,
    }
    reason = max(parts, key=lambda part: parts[part])
    return f"the best answer with it {reason}: {behind:.1f} less of log probability"


def _spoken(name: str) -> str:
    return name.replace("_", " ")


def _entry(
    diagnosis: Diagnosis, fitted: FittedEffect, status: str, probability: float, why: str
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
        "why": why,
    }
