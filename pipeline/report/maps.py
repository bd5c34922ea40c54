"""The map of where the simulator fails: channels over bins of a regime variable, before and after."""

import itertools
import math
from collections import defaultdict
from typing import Any

import numpy as np

from simgap.report.figure import INK, Figure, axis, encode, label, layout
from simgap.report.section import Drawing
from simgap.report.text import number, quantity, short, spoken, with_unit

_COLOURS = [[0.0, "var(--map-low)"], [0.5, "var(--map-middle)"], [1.0, "var(--map-high)"]]
_SIDES = {"before": (0.0, 0.475), "after": (0.525, 1.0)}  # of the width of the figure
_LEAST = 1e-3  # noise floors; what keeps the logarithm of an error of zero finite


def regime_maps(regimes: list[dict[str, Any]], drawing: Drawing) -> list[Figure]:
    """Draw channels over bins for every regime variable, the one that tells most first.

    The colour is the error as a multiple of the noise floor, on one logarithmic scale for all.
    """
    groups: dict[tuple, list[dict[str, Any]]] = defaultdict(list)
    for entry in regimes:
        groups[entry["variable"], tuple(entry["edges"])].append(entry)
    ratios = [over_floor(entry, stage) for entry in regimes for stage in _SIDES]
    everything = np.concatenate([*ratios, [2.0]])
    highest = float(everything[np.isfinite(everything)].max())
    telling = sorted(groups.values(), key=_contrast, reverse=True)
    return [_map(entries, highest, drawing) for entries in telling]


def over_floor(entry: dict[str, Any], stage: str) -> np.ndarray:
    """Return the error per bin as a multiple of the noise floor, (bins,); NaN where that is not known."""
    floor = entry.get("noise_floor") or np.nan
    return np.asarray(entry[stage], dtype=float) / floor


def _contrast(entries: list[dict[str, Any]]) -> float:
    """Return by which factor the error before varies over the bins, summed over the channels."""
    ratios = [ratio[np.isfinite(ratio)] for ratio in (over_floor(entry, "before") for entry in entries)]
    return sum(float(np.ptp(np.log(np.maximum(ratio, 1.0)))) for ratio in ratios if ratio.size)


def _map(entries: list[dict[str, Any]], highest: float, drawing: Drawing) -> Figure:
    edges = entries[0]["edges"]
    ticks = {
        "tickvals": list(range(len(edges))),
        "ticktext": [short(edge, 2) for edge in edges],
        "tickangle": 0,
        "tickfont": {"size": 11},
    }
    name = quantity(entries[0]["variable"], entries[0].get("unit"))
    # Equal widths for every bin: the edges are quantiles, and true widths would hide the crowded ones.
    left, right = (axis(name, domain=list(side), showgrid=False, **ticks) for side in _SIDES.values())
    y = axis("", autorange="reversed", showgrid=False, ticks="")
    both = layout(
        left,
        y,
        xaxis2=right | {"anchor": "y2"},
        yaxis2=y | {"anchor": "x2", "showticklabels": False, "matches": "y"},
        annotations=[_heading(stage, sum(side) / 2) for stage, side in _SIDES.items()],
    )
    data = [_heat(entries, stage, highest, drawing) for stage in _SIDES]
    return Figure(
        f"Error over {spoken(entries[0]['variable'])}", data, both, max(140 + 34 * len(entries), 240)
    )


def _heading(stage: str, middle: float) -> dict[str, Any]:
    place = {"x": middle, "y": 1, "xref": "paper", "yref": "paper", "yanchor": "bottom", "showarrow": False}
    return {"text": f"<b>{stage}</b>"} | place


def _heat(entries: list[dict[str, Any]], stage: str, highest: float, drawing: Drawing) -> dict[str, Any]:
    ratios = np.array([over_floor(entry, stage) for entry in entries])
    bins = ratios.shape[1]
    heat: dict[str, Any] = {
        "type": "heatmap",
        "x": [column + 0.5 for column in range(bins)],
        "y": [label(spoken(entry["channel"])) for entry in entries],
        "z": encode(np.log10(np.maximum(ratios, _LEAST))),
        "zmin": 0,
        "zmax": math.log10(highest),
        "colorscale": _COLOURS,
        "showscale": stage == "after",
        "colorbar": _scale(highest),
        "xgap": 2,
        "ygap": 2,
        "hovertext": [_hover(entry, stage) for entry in entries],
        "hoverinfo": "text",
    }
    if bins <= drawing.map_bins:
        text = [
            [number(ratio, 2) if math.isfinite(ratio) else "" for ratio in row] for row in ratios.tolist()
        ]
        heat |= {"text": text, "texttemplate": "%{text}"}
    return heat | ({"xaxis": "x2", "yaxis": "y2"} if stage == "after" else {})


def _scale(highest: float) -> dict[str, Any]:
    """Return the legend of the colours: ticks at 1, 2, 5, … noise floors, at decades over a wide range."""
    decades = range(math.ceil(math.log10(highest)) + 1)
    steps = [step * 10**decade for decade in decades for step in ((1, 2, 5) if highest < 40 else (1,))]
    ticks = [step for step in steps if step <= highest]
    shown = {"tickvals": [math.log10(step) for step in ticks], "ticktext": [str(step) for step in ticks]}
    title = {"text": "× noise floor", "side": "right"}
    return {"title": title, "thickness": 12, "outlinewidth": 0, "len": 1, "tickfont": {"color": INK}} | shown


def _hover(entry: dict[str, Any], stage: str) -> list[str]:
    unit, variable = entry.get("channel_unit"), label(spoken(entry["variable"]))
    floor = label(with_unit(number(entry.get("noise_floor")), unit))
    return [
        f"{label(entry['channel'])}, {stage}<br>{variable} {short(low)} to {short(high)}<br>"
        f"RMS error {label(with_unit(number(value), unit))}<br>noise floor {floor}"
        for value, (low, high) in zip(entry[stage], itertools.pairwise(entry["edges"]), strict=True)
    ]
