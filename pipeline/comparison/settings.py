"""Configuration of how the jobs of a sweep are compared."""

from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any


@dataclass
class TableOf:
    """One table: a row per configuration, a column per metric that matches."""

    metrics: str = "*"  # pattern of metric names, with * and ?
    title: str = ""
    mean: bool = False  # whether a last column holds the mean of the other columns
    variance: bool = False  # whether a column before it holds their variance


@dataclass
class Results:
    """The configuration group `results`."""

    title: str | None = None  # of the section in docs/results.md; null: no section
    text: str = ""  # Markdown under the title
    tables: list[TableOf] = field(default_factory=list)  # empty: one table for each group of metrics
    figure: TableOf | None = None  # the figure shows its last column; null: the first table
    baseline: dict[str, Any] = field(default_factory=dict)  # swept values of the baseline row
    # Of swept keys and of metrics, by name or pattern; the first that matches counts.
    units: dict[str, str] = field(default_factory=dict)

    def with_unit(self, name: str, heading: str) -> str:
        """Return a heading followed by the unit of the named quantity: `train.share (1)`, `time (s)`."""
        unit = next((unit for pattern, unit in self.units.items() if fnmatchcase(name, pattern)), "")
        return f"{heading} ({unit})" if unit else heading
