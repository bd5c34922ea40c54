"""What cleaning changed, and which stretches of each run were used."""

from collections import defaultdict
from collections.abc import Hashable, Iterable
from typing import Any

import pandas as pd

from simgap.report.inputs import ReportInputs, read_table
from simgap.report.section import Drawing, Section
from simgap.report.timeline import timeline


def cleaning_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Sum up the changes by step and reason, and draw the coverage of every run."""
    changes = read_table(inputs.clean, "changes.parquet")
    coverage = read_table(inputs.clean, "coverage.parquet")
    if changes is None and coverage is None:
        return None
    content: dict[str, Any] = {"summary": [], "details": [], "all": 0, "figure": None}
    if changes is not None and len(changes):
        details = changes.head(drawing.detail_rows).to_dict("records")
        content |= {"summary": summary(changes), "details": details, "all": len(changes)}
    if coverage is not None and len(coverage):
        content["figure"] = timeline(coverage, inputs.split)
    return Section("cleaning", "What cleaning changed", content)


def summary(changes: pd.DataFrame) -> list[dict[Hashable, Any]]:
    """Sum up by step and reason, in the order in which the steps ran.

    Samples and seconds are those of the column most concerned, summed over runs: a step that touches
    several columns at the same moments is not counted several times.
    """
    rows = changes.assign(column=changes["column"].fillna("").astype(str), size=changes["samples"].abs())
    keys = ["step", "reason"]
    per_column = rows.groupby([*keys, "run", "column"], sort=False)[["samples", "seconds", "size"]].sum()
    foremost = per_column.groupby([*keys, "run"], sort=False)["size"].idxmax()
    worst = per_column.loc[foremost].groupby(keys, sort=False)[["samples", "seconds"]].sum()
    table = rows.groupby(keys, sort=False).agg(columns=("column", condensed), runs=("run", "nunique"))
    return table.join(worst).reset_index().to_dict("records")


def condensed(columns: Iterable[str]) -> str:
    """Write columns as the contract does, `motor_speed_{1,2,3,4}`; whole samples have no column."""
    groups: dict[str, list[str]] = defaultdict(list)
    for column in dict.fromkeys(columns):
        stem, _, axis = column.rpartition("_")
        groups[f"{stem}_" if stem and len(axis) == 1 else column].append(axis)
    return ", ".join(
        f"{stem}{{{','.join(axes)}}}" if len(axes) > 1 else stem + axes[0] if stem.endswith("_") else stem
        for stem, axes in groups.items()
        if stem
    )
