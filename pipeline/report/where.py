"""Where the simulator fails: by channel, and over which regime."""

from typing import Any

from simgap.recordings.doubts import LARGEST_AT
from simgap.report.inputs import ReportInputs
from simgap.report.maps import regime_maps
from simgap.report.section import Drawing, Section
from simgap.report.text import apart, minus, spoken, with_unit


def where_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List the mismatches and map the error over regimes, before and after."""
    if inputs.diagnosis is None:
        return None
    regimes = inputs.evidence("regimes.json") or []
    units = {entry["variable"]: entry.get("unit") for entry in regimes}
    rows = [_row(entry, units) for entry in inputs.diagnosis.get("mismatch") or []]
    maps = regime_maps(regimes)
    content = {"verdict": inputs.diagnosis["verdict"], "rows": rows, "maps": maps, "shown": drawing.maps}
    return Section("where", "Where it fails", content)


def _row(entry: dict[str, Any], units: dict[str, str | None]) -> dict[str, Any]:
    regime = entry.get("regime") or {}
    text = ""
    if LARGEST_AT in (entry.get("where") or ""):
        low, high = apart([regime["low"], regime["high"]], digits=3)
        text = with_unit(f"{low} to {high}", units.get(regime["variable"]))
    where = minus(entry.get("where") or "")
    return entry | {
        "where": where,
        "regime_variable": spoken(regime.get("variable", "")),
        "regime_range": text,
    }
