"""The timeline of coverage: which stretches of each run were kept, filled, dropped or never recorded."""

from typing import Any

import numpy as np
import pandas as pd

from simgap.report.figure import Figure, axis, encode, label, layout
from simgap.report.text import spoken

# The states of a stretch in the order of the legend; one that is not listed is drawn in grey.
COLOURS = {
    "kept": "var(--after)",
    "interpolated": "var(--filled)",
    "dropped": "var(--before)",
    "missing": "var(--faint)",
}
_STRETCHES = 300  # drawn per run at most


def timeline(coverage: pd.DataFrame, split: dict[str, str]) -> Figure:
    """Draw one bar per run, in seconds since the run began, coloured by what became of each stretch.

    Args:
        coverage: columns run, start (s), end (s), state, reason; stretches in the order of time.
        split: part of each run, where it is known.
    """
    runs = list(dict.fromkeys(coverage["run"].astype(str)))
    tables = [
        simplified(rows).assign(row=row) for row, (_, rows) in enumerate(coverage.groupby("run", sort=False))
    ]
    stretches = pd.concat(tables, ignore_index=True)
    order = [*COLOURS, *sorted(set(stretches["state"]) - set(COLOURS))]
    data = [_bars(state, rows) for state in order if len(rows := stretches[stretches["state"] == state])]
    names = [label(f"{run} · {split[run]}" if run in split else run) for run in runs]
    y = axis("", tickvals=list(range(len(runs))), ticktext=names, range=[len(runs) - 0.4, -0.6], ticks="")
    x = axis("time since the run began (s)", range=[0, float(stretches["end"].max())])
    drawn = layout(x, y | {"showgrid": False, "zeroline": False}, barmode="overlay", bargap=0.35)
    return Figure("Which stretches of each run were used", data, drawn, 120 + 24 * len(runs))


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


def _bars(state: str, rows: pd.DataFrame) -> dict[str, Any]:
    spans = "for %{x:.3~r} s from %{base:.3~r} s<br>%{hovertext}<extra></extra>"
    return {
        "type": "bar",
        "orientation": "h",
        "name": label(state),
        "x": encode(rows["end"] - rows["start"]),
        "base": encode(rows["start"]),
        "y": rows["row"].tolist(),
        "hovertext": [label(reason, 90) for reason in rows["reason"]],
        "hovertemplate": f"{label(spoken(state))} {spans}",
        "textposition": "none",
        "marker": {"color": COLOURS.get(state, "var(--faint)"), "line": {"width": 0}},
    }
