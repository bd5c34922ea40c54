"""The figure of a comparison: curves over a swept number, or bars."""

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from simgap.comparison.comparison import Comparison, Value
from simgap.comparison.table import Row, Table, tables_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FIGURE = "comparison.svg"

_SIZE = (7.5, 4.2)  # inches
_WIDE = 10.0


def draw(comparison: Comparison, path: Path) -> bool:
    """Draw one metric of all configurations as SVG; return whether there were at least two configurations.

    The abscissa is the first swept key with only numbers. Every combination of the other keys has a curve, with a band
    of one standard deviation over the seeds. References are dashed lines.
    """
    table = _chosen(comparison)
    if table is None or sum(not row.reference for row in table.rows) < 2:
        return False
    import matplotlib
    from matplotlib.figure import Figure

    column = table.columns[-1]
    with matplotlib.rc_context({"svg.hashsalt": comparison.name, "svg.fonttype": "none"}):
        figure = Figure(figsize=_SIZE, layout="constrained")
        axes = figure.add_subplot()
        abscissa = _abscissa(table)
        _bars(axes, table, column) if abscissa is None else _curves(axes, table, column, abscissa)
        for number, row in enumerate(row for row in table.rows if row.reference):
            style = ("--", ":", "-.")[number % 3]
            axes.axhline(row.entries[column].mean, color="0.4", linestyle=style, label=row.reference)
        axes.set_ylabel(", ".join(filter(None, [table.title, column])))
        axes.set_yscale("log" if _is_wide(table, column) else "linear")
        axes.grid(alpha=0.3)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False)
        figure.savefig(path, format="svg", metadata={"Date": None})
    return True


def _chosen(comparison: Comparison) -> Table | None:
    """Return the table whose last column the figure shows."""
    wanted = comparison.results.figure
    if wanted is not None:
        comparison = replace(comparison, results=replace(comparison.results, tables=[wanted]))
    return next(iter(tables_of(comparison)), None)


def _is_wide(table: Table, column: str) -> bool:
    """Whether the values need a logarithmic axis.

    A band that reaches zero rules it out, because a logarithmic axis cannot show it.
    """
    entries = [row.entries[column] for row in table.rows]
    values = [entry.mean for entry in entries]
    lowest = min(entry.mean - (entry.std or 0.0) for entry in entries)
    return lowest > 0 and max(values) > _WIDE * min(values)


def _abscissa(table: Table) -> str | None:
    for key in table.keys:
        values = [row.values.get(key) for row in table.rows if not row.reference]
        if all(_is_number(value) for value in values) and len(set(values)) > 1:
            return key
    return None


def _curves(axes: "Axes", table: Table, column: str, abscissa: str) -> None:
    curves: dict[str, list[Row]] = {}
    for row in table.rows:
        if not row.reference:
            curves.setdefault(_named(row, abscissa), []).append(row)
    for name, rows in curves.items():
        rows.sort(key=lambda row: float(row.values[abscissa] or 0))
        places = [float(row.values[abscissa] or 0) for row in rows]
        means = [row.entries[column].mean for row in rows]
        spreads = [row.entries[column].std or 0.0 for row in rows]
        (line,) = axes.plot(places, means, marker="o", label=name or None)
        low = [mean - spread for mean, spread in zip(means, spreads, strict=True)]
        high = [mean + spread for mean, spread in zip(means, spreads, strict=True)]
        axes.fill_between(places, low, high, color=line.get_color(), alpha=0.2, linewidth=0)
    axes.set_xlabel(table.named.get(abscissa, abscissa))


def _bars(axes: "Axes", table: Table, column: str) -> None:
    rows = [row for row in table.rows if not row.reference]
    means = [row.entries[column].mean for row in rows]
    spreads = [row.entries[column].std or math.nan for row in rows]  # one seed has no error bar
    places = range(len(rows))
    axes.bar(places, means, yerr=spreads, width=0.6, capsize=4)
    axes.set_xticks(places, [_named(row) for row in rows], rotation=20 if len(rows) > 4 else 0)


def _named(row: Row, without: str = "") -> str:
    """Return the label of a configuration. Numbers and flags carry their key."""
    return ", ".join(_labelled(key, value) for key, value in row.values.items() if key != without)


def _labelled(key: str, value: Value) -> str:
    if isinstance(value, bool):
        return f"{key.partition('.')[2] or key} {value}"
    return f"{key.rpartition('.')[2]} {value}" if _is_number(value) else str(value)


def _is_number(value: Value) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
