"""The map of where the simulator fails: channels over bins of a regime variable, before and after, as a table."""

import itertools
import math
from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import numpy as np

from simgap.report.text import NARROW_SPACE, UNKNOWN, apart, number, quantity, short, spoken, with_unit

STAGES = ("before", "after")
_LEAST = 1e-3  # noise floors; what keeps the logarithm of an error of zero finite
_SMALLEST = 0.01  # noise floors that are written as a number


@dataclass(frozen=True)
class Cell:
    """One bin of one channel.

    Attributes:
        text: error as a multiple of the noise floor; a dash where it is not known.
        depth: of the colour, 0 at the noise floor or below to 100 at the greatest error of all maps; None where the
            error is not known.
        said: the same with value and unit.
    """

    text: str
    depth: float | None
    said: str


@dataclass(frozen=True)
class RegimeMap:
    """Error of every channel over the bins of one variable.

    Attributes:
        caption: heading.
        variable: name with unit.
        bins: lower and upper end of each, as text.
        rows: name of each channel with its cells by stage, before and after.
    """

    caption: str
    variable: str
    bins: list[tuple[str, str]]
    rows: list[tuple[str, dict[str, list[Cell]]]]


def regime_maps(regimes: list[dict[str, Any]]) -> list[RegimeMap]:
    """Return channels over bins for every regime variable, the one that tells most first.

    The colour is the error as a multiple of the noise floor, on one logarithmic scale for all.
    """
    groups: dict[tuple, list[dict[str, Any]]] = defaultdict(list)
    for entry in regimes:
        groups[entry["variable"], tuple(entry["edges"])].append(entry)
    ratios = [over_floor(entry, stage) for entry in regimes for stage in STAGES]
    everything = np.concatenate([*ratios, [2.0]])
    highest = float(everything[np.isfinite(everything)].max())
    telling = sorted(groups.values(), key=_contrast, reverse=True)
    return [_map(entries, highest) for entries in telling]


def over_floor(entry: dict[str, Any], stage: str) -> np.ndarray:
    """Return the error per bin as a multiple of the noise floor, (bins,); NaN where that is not known."""
    floor = entry.get("noise_floor") or np.nan
    return np.asarray(entry[stage], dtype=float) / floor


def _contrast(entries: list[dict[str, Any]]) -> float:
    """Return by which factor the error before varies over the bins, summed over the channels."""
    ratios = [ratio[np.isfinite(ratio)] for ratio in (over_floor(entry, "before") for entry in entries)]
    return sum(float(np.ptp(np.log(np.maximum(ratio, 1.0)))) for ratio in ratios if ratio.size)


def _map(entries: list[dict[str, Any]], highest: float) -> RegimeMap:
    first = entries[0]
    bins = list(itertools.pairwise(apart(first["edges"])))
    rows = [
        (spoken(entry["channel"]), {stage: _cells(entry, stage, bins, highest) for stage in STAGES})
        for entry in entries
    ]
    variable = quantity(first["variable"], first.get("unit"))
    return RegimeMap(f"Error over {spoken(first['variable'])}", variable, bins, rows)


def _cells(entry: dict[str, Any], stage: str, bins: list[tuple[str, str]], highest: float) -> list[Cell]:
    unit = entry.get("channel_unit")
    floor = with_unit(number(entry.get("noise_floor")), unit)
    ratios = over_floor(entry, stage)
    depths = 100 * np.log10(np.maximum(np.nan_to_num(ratios, nan=1.0), _LEAST)) / math.log10(highest)
    cells = []
    for ratio, depth, value, (low, high) in zip(ratios, depths, entry[stage], bins, strict=True):
        there = f"{stage}, {spoken(entry['variable'])} {low} to {high}"
        error = with_unit(number(value), unit) if value is not None and math.isfinite(value) else UNKNOWN
        said = f"{there}: RMS error {error}, noise floor {floor}"
        if math.isfinite(ratio):
            cells.append(Cell(_multiple(float(ratio)), round(float(np.clip(depth, 0.0, 100.0)), 1), said))
        else:
            cells.append(Cell("–", None, said))
    return cells


def _multiple(ratio: float) -> str:
    return f"<{NARROW_SPACE}{_SMALLEST:g}" if ratio < _SMALLEST else short(ratio, 2)
