"""Configuration of how the jobs of a sweep are compared."""

from dataclasses import dataclass, field
from typing import Any


@dataclass
class TableOf:
    """One table: a row per configuration, a column per metric that matches."""

    metrics: str = "*"  # pattern of metric names, with * and ?
    title: str = ""
    mean: bool = False  # whether a last column holds the mean of the other columns


@dataclass
class Results:
    """The configuration group `results`."""

    title: str | None = None  # of the section in docs/results.md; null: no section
    text: str = ""  # Markdown under the title
    tables: list[TableOf] = field(default_factory=list)  # empty: one table for each group of metrics
    figure: TableOf | None = None  # the figure shows its last column; null: the first table
    baseline: dict[str, Any] = field(default_factory=dict)  # swept values of the baseline row
