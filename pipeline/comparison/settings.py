"""What a person may say about how the jobs of a sweep are compared."""

from dataclasses import dataclass, field
from fnmatch import fnmatchcase
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
    units: dict[str, str] = field(
        default_factory=dict
    )  # of swept keys and of metrics, by name or pattern; the first that matches counts

    def with_unit(self, name: str, heading: str) -> str:
        """Return a heading followed by the unit of what it names: `train.share (1)`, `time (s)`."""
        unit = next((unit for pattern, unit in self.units.items() if fnmatchcase(name, pattern)), "")
        return f"{heading} ({unit})" if unit else heading
