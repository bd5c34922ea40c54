"""What cleaning changed, and which stretches of each run were used."""

from collections.abc import Hashable
from typing import Any

import pandas as pd

from pipeline.report.figure import Figure, axis, encode, label, layout
from pipeline.report.inputs import ReportInputs, read_table
from pipeline.report.section import Drawing, Section
from pipeline.report.text import number, spoken

# The states of a stretch in the order of the legend; one that is not listed is drawn in grey.
_COLOURS = {
    "kept": "var(--after)",
    "interpolated": "var(--filled)",
    "dropped": "var(--before)",
    "missing": "var(--faint)",
}


def cleaning_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Sum up the changes by step, column and reason, and draw the coverage of every run."""
    changes = read_table(inputs.clean, "changes.parquet")
    coverage = read_table(inputs.clean, "coverage.parquet")
    if changes is None and coverage is None:
        return None
    content: dict[str, Any] = {"summary": [], "details": [], "all": 0, "figure": None}
    if changes is not None and len(changes):
        details = changes.head(drawing.detail_rows).to_dict("records")
        content |= {"summary": summary(changes), "details": details, "all": len(changes)}
    if coverage is not None and len(coverage):
        content["figure"] = _timeline(coverage, inputs.split)
    return Section("cleaning", "What cleaning changed", content)


def summary(changes: pd.DataFrame) -> list[dict[Hashable, Any]]:
    """Sum samples and seconds over runs, in the order in which the steps ran."""
    keys = ["step", "column", "reason"]
    rows = changes.assign(column=changes["column"].fillna("").astype(str))
    groups = rows.groupby(keys, sort=False, dropna=False)
    table = groups.agg(runs=("run", "nunique"), samples=("samples", "sum"), seconds=("seconds", "sum"))
    return table.reset_index().to_dict("records")


def _timeline(coverage: pd.DataFrame, split: dict[str, str]) -> Figure:
    """Draw one bar per run, in seconds since the run began, coloured by what became of each stretch."""
    runs = list(dict.fromkeys(coverage["run"].astype(str)))
    row = {run: index for index, run in enumerate(runs)}
    started = coverage.groupby("run")["start"].transform("min")
    stretches = coverage.assign(
        row=coverage["run"].astype(str).map(row),
        base=coverage["start"] - started,
        run=coverage["run"].astype(str),
    )
    data = [_bars(str(state), rows) for state, rows in stretches.groupby("state", sort=False)]
    data.sort(
        key=lambda trace: list(_COLOURS).index(trace["name"]) if trace["name"] in _COLOURS else len(_COLOURS)
    )
    names = [label(f"{run} · {split[run]}" if run in split else run) for run in runs]
    y = axis("", tickvals=list(range(len(runs))), ticktext=names, range=[len(runs) - 0.4, -0.6], ticks="")
    drawn = layout(
        axis("time since the run began (s)", range=[0, float((coverage["end"] - started).max())]),
        y | {"showgrid": False, "zeroline": False},
        barmode="overlay",
        bargap=0.35,
    )
    return Figure("Which stretches of each run were used", data, drawn, 120 + 24 * len(runs))


def _bars(state: str, rows: pd.DataFrame) -> dict[str, Any]:
    hover = [
        f"{label(entry['run'])}<br>{label(spoken(state))} {number(entry['base'])} s to"
        f" {number(entry['base'] + entry['end'] - entry['start'])} s<br>{label(entry['reason'] or '', 90)}"
        for entry in rows.to_dict("records")
    ]
    return {
        "type": "bar",
        "orientation": "h",
        "name": label(state),
        "x": encode(rows["end"] - rows["start"]),
        "base": encode(rows["base"]),
        "y": rows["row"].tolist(),
        "hovertext": hover,
        "hoverinfo": "text",
        "textposition": "none",
        "marker": {"color": _COLOURS.get(state, "var(--faint)"), "line": {"width": 0}},
    }
