"""The residual against the variable that explains it, with the fitted law drawn through it."""

from typing import Any

import numpy as np
import pandas as pd

from simgap.report.figure import AFTER, BEFORE, INK, Figure, Mark, line, points
from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.text import quantity, spoken


def laws_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Draw every fitted law through the residuals that it explains."""
    laws = inputs.evidence("laws.json")
    if not laws:
        return None
    residuals = inputs.evidence("residuals.parquet")
    strongest = sorted(laws, key=lambda law: _strength(law, residuals), reverse=True)
    figures = [_figure(law, residuals, drawing) for law in strongest]
    return Section("laws", "The law in the residual", {"figures": figures, "shown": drawing.laws})


def _strength(law: dict[str, Any], residuals: pd.DataFrame | None) -> float:
    """Return how far the law reaches, in standard deviations of the channel's residual before."""
    heights = np.asarray(law["law"], dtype=float)  # with gaps
    reach = float(np.nanmax(heights) - np.nanmin(heights))
    if residuals is None:
        return reach
    spread = float(residuals.loc[residuals["channel"] == law["channel"], "before"].std())
    return reach / spread if spread > 0 else 0.0


def _figure(law: dict[str, Any], residuals: pd.DataFrame | None, drawing: Drawing) -> Figure:
    marks = [] if residuals is None else _clouds(law, residuals, drawing)
    if (law.get("bins") or {}).get("x"):
        marks.append(_means(law["bins"]))
    marks.append(
        line(law["x"], law["law"], "law", INK, width=2.5, dot=1.5)
    )  # a dot: a point alone is no line
    x = quantity(law["variable"], law.get("variable_unit"))
    y = quantity(f"residual of {law['channel']}", law.get("unit"))
    caption = f"{spoken(law['effect'])}: residual of {spoken(law['channel'])} over {spoken(law['variable'])}"
    return Figure(caption[:1].upper() + caption[1:], x, y, marks, 340)


def _clouds(law: dict[str, Any], residuals: pd.DataFrame, drawing: Drawing) -> list[Mark]:
    """Return the held-out residuals (all, where none is held out) before and after, evenly thinned."""
    variable = law["variable"]
    if variable not in residuals.columns:
        return []
    rows = residuals[residuals["channel"] == law["channel"]].dropna(subset=[variable])
    held_out = rows[rows["part"] == "holdout"] if "part" in rows else rows
    rows = held_out if len(held_out) else rows
    if rows.empty:
        return []
    kept = np.linspace(0, len(rows) - 1, min(len(rows), drawing.scatter_samples)).astype(int)
    rows = rows.iloc[np.unique(kept)]
    return [
        points(rows[variable], rows[stage], stage, colour, dot=1.8, opacity=0.4, silent=True)
        for stage, colour in (("before", BEFORE), ("after", AFTER))
    ]


def _means(bins: dict[str, Any]) -> Mark:
    bounds = (bins["low"], bins["high"])
    return points(bins["x"], bins["mean"], "left by the others", INK, bounds, dot=3.5, hollow=True)
