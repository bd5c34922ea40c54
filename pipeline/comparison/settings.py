"""Settings of the comparison of a sweep."""

from dataclasses import dataclass, field
from typing import Any


@dataclass
class TableOf:
    """One table: a row per configuration, a column per metric that matches."""

    metrics: str = "*"  # pattern of their names, with * and ?
    title: str = ""
    mean: bool = False  # whether a last column holds the mean of the others


@dataclass
class Results:
    """The configuration group `results`."""

    title: str | None = None  # of the section in docs/results.md; null: the sweep has none there
    text: str = ""  # one sentence under the title
    tables: list[TableOf] = field(default_factory=list)  # empty: one for each group of metrics
    figure: TableOf | None = None  # whose last column is drawn; null: the first table
    baseline: dict[str, Any] = field(
        default_factory=dict
    )  # swept values of the row that others are held against
