"""The diagnosis as the file that others read (`diagnosis.json`, schema simgap.diagnosis/1)."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from simgap.diagnosis.diagnose import Diagnosis
from simgap.effects.told import UNTOLD, is_told
from simgap.equations.presence import Presence
from simgap.gap.name import Named, Rivalry
from simgap.simulation import FittedEffect

SCHEMA = "simgap.diagnosis/1"


def diagnosis_document(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the diagnosis as plain numbers, texts and lists."""
    fitted = {f.effect.key: f for f in diagnosis.simulator.effects}
    effects = [
        _effect(diagnosis, named, fitted.get(named.effect.key, named.fitted))
        for named in diagnosis.naming.named
    ]
    validation = diagnosis.validation
    return {
        "schema": SCHEMA,
        "verdict": diagnosis.verdict,
        "contradictions": [asdict(contradiction) for contradiction in diagnosis.contradictions],
        "warnings": list(diagnosis.warnings),
        "mismatch": [_mismatch(m) for m in diagnosis.mismatches],
        "effects": sorted(effects, key=lambda effect: -effect["probability"]),
        "ambiguous": [ambiguous(rivalry, fitted) for rivalry in diagnosis.naming.rivalries],
        "unnamed": [
            {
                "channel": u.channel.name,
                "depends_on": list(u.depends_on),
                "formula": u.formula,
                "share": u.share,
                "size": {"value": u.size, "noise": u.noise, "unit": u.channel.unit},
            }
            for u in diagnosis.unnamed
        ],
        "fit": {
            "metric": validation.metric,
            "held_out_runs": list(validation.held_out_runs),
            "before": validation.before,
            "after": validation.after,
            "noise_floor": validation.noise_floor,
            "gap_closed": validation.gap_closed,
            "gap_closed_interval": list(validation.interval) if validation.interval else None,
        },
    }


def _mismatch(mismatch: Any) -> dict[str, Any]:
    variable, low, high = mismatch.regime
    return {
        "channel": mismatch.channel.name,
        "share": mismatch.share,
        "regime": {"variable": variable, "low": low, "high": high},
        "p_value": mismatch.p_value,
        "where": mismatch.where,
    }


def _effect(diagnosis: Diagnosis, named: Named, fitted: FittedEffect) -> dict[str, Any]:
    effect, unit = named.effect, diagnosis.simulator.position_unit
    units = effect.units(unit)
    acts_on = "force" if effect.acts_on == "torque" and unit == "m" else effect.acts_on
    entry = {
        "name": effect.name,
        "subject": effect.subject(fitted.values) or None,
        "probability": named.probability,
        "acts_on": acts_on,
        "parameters": {
            name: {"value": value, "std": fitted.std[name], "unit": units[name]}
            for name, value in fitted.values.items()
        },
    }
    statement = effect.statement(fitted.values, unit) if is_told(entry) else UNTOLD
    presence = diagnosis.fitting.presence
    if not isinstance(presence, Presence) or effect.key not in presence.keys:
        return entry | {"statement": statement}
    where = presence.sentence(diagnosis.fitting.blocks.runs)
    said = f"{statement.removesuffix('.')}; {where[0].lower()}{where[1:]}"
    return entry | {"runs": presence.entries, "statement": said}


def ambiguous(rivalry: Rivalry, fitted: Mapping[str, FittedEffect]) -> dict[str, Any]:
    """Return the names that are not told apart; an effect that is not in the simulator has no values."""
    effects = (rivalry.winner, *rivalry.rivals)
    values = [fitted[e.key].values if e.key in fitted else e.neutral() for e in effects]
    advice = "; ".join(dict.fromkeys(effect.excitation for effect in effects))
    return {
        "names": [effect.name for effect in effects],
        "subjects": [effect.subject(known) or None for effect, known in zip(effects, values, strict=True)],
        "separate_by": f"{advice[0].upper()}{advice[1:]}.",
    }


def write_json(content: Any, path: Path) -> None:
    """Write JSON with numbers that every reader takes: what is not finite becomes null."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(_finite(content), indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
