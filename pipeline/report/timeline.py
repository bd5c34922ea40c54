"""The timeline of coverage: which stretches of each run were kept, filled, dropped or never recorded."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from simgap.report.text import short, spoken

# The states of a stretch in the order of the legend; one that is not listed is drawn in grey.
COLOURS = {
    "kept": "var(--after)",
    "interpolated": "var(--filled)",
    "dropped": "var(--before)",
    "missing": "var(--faint)",
}
_STRETCHES = 300  # drawn per run at most
_TICKS = 6  # of the axis at most
_SCALE = 1000  # of the whole axis, in the units of the drawing


@dataclass(frozen=True)
class Timeline:
    """Bars of runs over time.

    Attributes:
        legend: state and colour, of those that there are.
        rows: name, part of the split, and stretches of each run: `x` and `width` of 1000, `colour`, `said`.
        ticks: place along the axis in percent, and seconds as text.
    """

    legend: list[tuple[str, str]]
    rows: list[tuple[str, str, list[dict[str, Any]]]]
    ticks: list[tuple[float, str]]


def timeline(coverage: pd.DataFrame, split: dict[str, str]) -> Timeline:
    """Lay out one bar per run, in seconds since the run began, coloured by what became of each stretch.

    Args:
        coverage: columns run, start (s), end (s), state, reason; stretches in the order of time.
        split: part of each run, where it is known.
    """
    runs = {str(run): simplified(rows) for run, rows in coverage.groupby("run", sort=False)}
    longest = max(float(rows["end"].max()) for rows in runs.values()) or 1.0
    found = {state for rows in runs.values() for state in rows["state"]}
    order = [state for state in COLOURS if state in found] + sorted(found - set(COLOURS))
    legend = [(spoken(state), COLOURS.get(state, "var(--faint)")) for state in order]
    rows = [(run, split.get(run, ""), _stretches(rows, longest)) for run, rows in runs.items()]
    return Timeline(legend, rows, _ticks(longest))


def simplified(rows: pd.DataFrame) -> pd.DataFrame:
    """Count one run's time from its start; one that is too finely cut is looked at in evenly spaced moments.

    Each state then keeps its share of the time, though not every stretch.
    """
    start, end = rows["start"].to_numpy(float), rows["end"].to_numpy(float)
    began = start.min()
    state, reason = rows["state"].astype(str).to_numpy(), rows["reason"].fillna("").astype(str).to_numpy()
    if len(rows) > _STRETCHES:
        edges = np.linspace(began, end.max(), _STRETCHES + 1)
        seen = np.searchsorted(start, (edges[:-1] + edges[1:]) / 2, side="right") - 1
        first = np.flatnonzero(np.append(True, state[seen][1:] != state[seen][:-1]))
        start, end = edges[first], edges[np.append(first[1:], _STRETCHES)]
        state, reason = state[seen[first]], reason[seen[first]]
    return pd.DataFrame({"start": start - began, "end": end - began, "state": state, "reason": reason})


def _ticks(longest: float) -> list[tuple[float, str]]:
    """Return round numbers of seconds along an axis, so few that they do not touch on a phone."""
    power = 10.0 ** math.floor(math.log10(longest / _TICKS))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power * _TICKS >= longest)
    return [(round(100.0 * k * step / longest, 2), short(k * step)) for k in range(int(longest / step) + 1)]


def _stretches(rows: pd.DataFrame, longest: float) -> list[dict[str, Any]]:
    stretches = []
    for start, end, state, reason in rows.itertuples(index=False):
        said = f"{spoken(state)} for {short(end - start)} s from {short(start)} s"
        stretches.append(
            {
                "x": round(_SCALE * start / longest, 2),
                "width": round(_SCALE * (end - start) / longest, 2),
                "colour": COLOURS.get(state, "var(--faint)"),
                "said": f"{said}: {reason}" if reason else said,
            }
        )
    return stretches
