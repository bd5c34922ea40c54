"""The fit before and after, on held-out runs, against the noise floor."""

from typing import Any

from simgap.report.figure import (
    AFTER,
    AFTER_BAND,
    BEFORE,
    BEFORE_BAND,
    FLOOR,
    Figure,
    band,
    line,
)
from simgap.report.improvement import NO_INTERVAL, sureness, why_unknown
from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.text import is_number, quantity, short, spoken

_WORSE = 1.05  # times the error before, from which on it is said to be greater
_DIVERGENCE = 50.0  # ratio of the largest errors before and after


def fit_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Compare the errors before and after, and draw how they grow over the horizon."""
    if inputs.diagnosis is None:
        return None
    fit = inputs.diagnosis.get("fit") or {}
    horizons = inputs.evidence("horizon.json") or []
    learned = inputs.evidence("learned.json") or {}
    content = {
        "fit": fit,
        "named": bool(inputs.diagnosis["effects"]),
        "unknown": why_unknown(fit),
        "sureness": sureness(fit),
        "bands": "Bands are bootstrap intervals over runs" if any(map(_has_band, horizons)) else NO_INTERVAL,
        "bars": _bars(fit | {"learned": learned.get("after")}),
        "learned": learned.get("channels") or [],
        "learned_closes": learned.get("gap_closed"),
        "worse": [said for entry in horizons if (said := _worse(entry))],
        "horizons": [_horizon(entry) for entry in horizons if entry.get("horizon")],
    }
    return Section("fit", "Fit before and after", content)


def _worse(entry: dict[str, Any]) -> str:
    """Say over which horizons an error is greater after than before; empty where it is nowhere by more than 5 %."""
    triples = zip(entry.get("horizon") or [], entry["before"], entry["after"], strict=True)
    known = [triple for triple in triples if all(map(is_number, triple)) and triple[1] > 0]
    worse = {time: after / before for time, before, after in known if after > _WORSE * before}
    if not worse:
        return ""
    first, last = short(min(worse)), short(max(worse))
    span = f"at {first} s" if first == last else f"between {first} and {last} s"
    return f"{spoken(entry['quantity'])} {span} ({short(max(worse.values()), 2)} times at most)"


def _bars(fit: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the errors with their lengths as a percentage of the longest."""
    named = [
        ("before", "Simulator as given"),
        ("after", "With what was found"),
        ("learned", "And what was learned of the rest"),
        ("noise_floor", "Noise floor"),
    ]
    known = [(key, name, fit[key]) for key, name in named if is_number(fit.get(key))]
    longest = max((abs(value) for _, _, value in known), default=0.0) or 1.0
    return [
        {"key": key, "name": name, "value": value, "length": round(100 * abs(value) / longest, 2)}
        for key, name, value in known
    ]


def _horizon(entry: dict[str, Any]) -> Figure:
    time = entry["horizon"]
    marks = []
    for key, colour, shade in (("before", BEFORE, BEFORE_BAND), ("after", AFTER, AFTER_BAND)):
        if _has_band(entry, key):
            marks.append(band(time, entry[f"{key}_low"], entry[f"{key}_high"], shade))
        marks.append(line(time, entry[key], key, colour, dot=2.5))
    if floor := entry.get("noise_floor"):
        level = floor if isinstance(floor, list) else [floor] * len(time)
        marks.append(line(time, level, "noise floor", FLOOR, dash=True, width=1.5))
    title = quantity(f"{entry['quantity']} error", entry.get("unit"))
    caption = f"Error of {spoken(entry['quantity'])} over the horizon"
    log = _diverges(entry)
    return Figure(caption, "horizon (s)", title, marks, 300, log=log, zero=not log)


def _has_band(entry: dict[str, Any], key: str = "after") -> bool:
    """Whether the interval of an error is known: one run alone has none."""
    bounds = [entry.get(f"{key}_low"), entry.get(f"{key}_high")]
    return all(bound and all(map(is_number, bound)) for bound in bounds)


def _diverges(entry: dict[str, Any]) -> bool:
    """Whether the error before is so large that the one after would lie flat on a linear axis."""
    before, after = (max(filter(is_number, entry[stage]), default=0.0) for stage in ("before", "after"))
    return before > _DIVERGENCE * after > 0
