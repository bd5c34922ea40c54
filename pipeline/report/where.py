"""Where the simulator fails: by channel, and over which regime."""

import itertools
from collections import defaultdict
from typing import Any

import numpy as np

from pipeline.report.figure import INK, Figure, axis, encode, label, layout
from pipeline.report.inputs import ReportInputs
from pipeline.report.section import Drawing, Section
from pipeline.report.text import number, quantity, short, spoken, with_unit

_SHOWN = 3  # maps that are open when the page is opened
_MAP_COLOURS = [[0.0, "var(--map-low)"], [0.5, "var(--map-middle)"], [1.0, "var(--map-high)"]]


def where_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List the mismatches and map the error over regimes, before and after."""
    mismatches = (inputs.diagnosis or {}).get("mismatch") or []
    regimes = inputs.evidence("regimes.json") or []
    if inputs.diagnosis is None:
        return None
    described = [*regimes, *(inputs.evidence("laws.json") or [])]
    units = {entry["variable"]: entry["variable_unit"] for entry in described if entry.get("variable_unit")}
    rows = [_row(entry, units) for entry in mismatches]
    content = {"verdict": inputs.diagnosis["verdict"], "rows": rows, "maps": regime_maps(regimes, drawing)}
    return Section("where", "Where it fails", content | {"shown": _SHOWN})


def regime_maps(regimes: list[dict[str, Any]], drawing: Drawing) -> list[Figure]:
    """Draw channels over bins for every regime variable, the one that tells most first.

    The colour is the error as a multiple of the noise floor, on one scale for all.
    """
    groups: dict[tuple, list[dict[str, Any]]] = defaultdict(list)
    for entry in regimes:
        groups[entry["variable"], tuple(entry["edges"])].append(entry)
    ratios = [_over_floor(entry, stage) for entry in regimes for stage in ("before", "after")]
    finite = np.concatenate([*ratios, [2.0]])
    highest = float(np.nanmax(finite[np.isfinite(finite)]))
    telling = sorted(groups.values(), key=_contrast, reverse=True)
    return [_map(entries, highest, drawing) for entries in telling]


def _contrast(entries: list[dict[str, Any]]) -> float:
    """Return how much the error before varies over the bins of one channel at most, in noise floors."""
    ratios = [ratio[np.isfinite(ratio)] for ratio in (_over_floor(entry, "before") for entry in entries)]
    return max((float(np.ptp(ratio)) for ratio in ratios if ratio.size), default=0.0)


def _row(entry: dict[str, Any], units: dict[str, str | None]) -> dict[str, Any]:
    regime = entry.get("regime") or {}
    text = ""
    if regime:
        low, high = short(regime.get("low")), short(regime.get("high"))
        text = with_unit(f"{low} to {high}", units.get(regime["variable"]))
    return entry | {"regime_variable": spoken(regime.get("variable", "")), "regime_range": text}


def _over_floor(entry: dict[str, Any], stage: str) -> np.ndarray:
    """Return the error per bin as a multiple of the noise floor; NaN where that is not known."""
    floor = entry.get("noise_floor") or np.nan
    return np.asarray(entry[stage], dtype=float) / floor


def _map(entries: list[dict[str, Any]], highest: float, drawing: Drawing) -> Figure:
    edges = entries[0]["edges"]
    data = [_heat(entries, stage, highest, drawing, index) for index, stage in enumerate(("before", "after"))]
    ticks = {"tickvals": list(range(len(edges))), "ticktext": [short(edge) for edge in edges]}
    name = quantity(entries[0]["variable"], entries[0].get("variable_unit"))
    # Equal widths for every bin: the edges are quantiles, and true widths would hide the crowded ones.
    x_axes = [axis(name, domain=domain, showgrid=False, **ticks) for domain in ([0, 0.475], [0.525, 1])]
    y = axis("", autorange="reversed", showgrid=False, ticks="")
    headings = [
        {
            "text": f"<b>{stage}</b>",
            "x": middle,
            "y": 1,
            "xref": "paper",
            "yref": "paper",
            "showarrow": False,
            "yanchor": "bottom",
        }
        for stage, middle in (("before", 0.2375), ("after", 0.7625))
    ]
    hidden = axis("", autorange="reversed", showgrid=False, showticklabels=False, ticks="", matches="y")
    both = layout(
        x_axes[0],
        y,
        xaxis2=x_axes[1] | {"anchor": "y2"},
        yaxis2=hidden | {"anchor": "x2"},
        annotations=headings,
    )
    return Figure(f"Error over {spoken(entries[0]['variable'])}", data, both, 140 + 34 * len(entries))


def _heat(entries: list[dict[str, Any]], stage: str, highest: float, drawing: Drawing, index: int) -> dict:
    errors = np.array([entry[stage] for entry in entries], dtype=float)
    bins = errors.shape[1]
    ranges = [f"{short(low)} to {short(high)}" for low, high in itertools.pairwise(entries[0]["edges"])]
    hover = [
        [
            f"{label(entry['channel'])}, {stage}<br>{label(spoken(entry['variable']))} {span}<br>"
            f"RMS {label(with_unit(number(value), entry.get('unit')))}<br>"
            f"noise floor {label(with_unit(number(entry.get('noise_floor')), entry.get('unit')))}"
            for value, span in zip(row, ranges, strict=True)
        ]
        for entry, row in zip(entries, errors.tolist(), strict=True)
    ]
    shown = {
        "text": [[number(value, 2) for value in row] for row in errors.tolist()],
        "texttemplate": "%{text}",
    }
    bar = {"title": {"text": "× noise floor", "side": "right"}, "thickness": 12, "outlinewidth": 0, "len": 1}
    return {
        "type": "heatmap",
        "x": [column + 0.5 for column in range(bins)],
        "y": [label(quantity(entry["channel"], entry.get("unit"))) for entry in entries],
        "z": encode([_over_floor(entry, stage) for entry in entries]),
        "zmin": 1,
        "zmax": highest,
        "colorscale": _MAP_COLOURS,
        "showscale": index == 1,
        "colorbar": bar | {"tickfont": {"color": INK}},
        "xgap": 2,
        "ygap": 2,
        "hovertext": hover,
        "hoverinfo": "text",
        "xaxis": "x2" if index else "x",
        "yaxis": "y2" if index else "y",
        **(shown if bins <= drawing.map_bins else {}),
    }
