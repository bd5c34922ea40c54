"""How planned motions went: what was foreseen with each simulator, and what the trials on the machine became."""

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simgap.report.inputs import ReportInputs, read_json
from simgap.report.section import Drawing, Section
from simgap.report.tables import Table
from simgap.report.text import estimate, number, spoken

_MAIN = "policy"
_FORESEEN, _TRIALS = "foreseen/", "trials/"
_HEADER = [
    "",
    "planned, s",
    "foreseen with smoothed voltages, s",
    "on the machine, s",
    "within the target",
    "mean miss, m",
    "worst miss, m",
]


def driven_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Compare the motions that were planned, and those of them that were driven, if there are any."""
    planned = _planned(read_json(inputs.profile, "metrics.json") or {})
    if not planned:
        return None
    trials = _driven(read_json(inputs.deploy, "metrics.json") or {})
    rows = [[spoken(name), number(time), *_outcome(trials.get(name))] for name, time in planned.items()]
    pictures = [*_pictures(inputs.profile), *_pictures(inputs.deploy)]
    return Section("driven", "Motions", {"table": Table("", _HEADER, rows), "pictures": pictures})


def _planned(metrics: Mapping[str, Any]) -> dict[str, Any]:
    """Return the planned time of every motion, s."""
    endings = "/time"
    return {
        name.removesuffix(endings): value
        for name, value in metrics.items()
        if name.endswith(endings) and name.count("/") == 1
    }


def _driven(metrics: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the measures of every motion that was driven; those without a name are of the policy's."""
    found: dict[str, dict[str, Any]] = {}
    for name, value in metrics.items():
        for part in (_FORESEEN, _TRIALS):
            motion, there, measure = name.rpartition(part)
            if there:
                found.setdefault(motion.rstrip("/") or _MAIN, {})[f"{part}{measure}"] = value
    return found


def _outcome(measures: Mapping[str, Any] | None) -> list[str]:
    if measures is None:
        return ["–"] * (len(_HEADER) - 2)
    inside = f"{measures['trials/inside']:.0f} of {measures['trials/number']:.0f}"
    return [
        number(measures["foreseen/time"]),
        estimate(measures["trials/time"], measures.get("trials/spread_time")),
        inside,
        estimate(measures["trials/mean_miss"], measures.get("trials/spread_miss")),
        number(measures["trials/worst_miss"]),
    ]


def _pictures(folder: Path | None) -> list[str]:
    """Return the drawings of a stage, encoded."""
    paths = sorted(folder.glob("*.svg")) if folder is not None else []
    return [base64.b64encode(path.read_bytes()).decode("ascii") for path in paths]
