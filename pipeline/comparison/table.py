"""A comparison as tables: a row per configuration over all of its seeds, and a column per metric."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from simgap.comparison.comparison import Comparison, Metrics, Value
from simgap.comparison.settings import TableOf

MEAN = "mean"
VARIANCE = "variance"
UNSWEPT = "as configured"  # label of the single row of a sweep over seeds alone


@dataclass(frozen=True)
class Estimate:
    """A metric over seeds.

    Attributes:
        mean: NaN if a job lacks the metric.
        std: standard deviation; None for one seed.
    """

    mean: float
    std: float | None = None

    @classmethod
    def of(cls, values: Sequence[float | None]) -> "Estimate":
        """Return mean and standard deviation of the values of all seeds."""
        known = np.array(values, dtype=float)  # None becomes NaN
        apart = known - known[:1]  # equal values differ by nothing, where their mean is rounded
        return cls(float(known.mean()), float(apart.std(ddof=1)) if len(known) > 1 else None)


@dataclass(frozen=True)
class Row:
    """One configuration or one reference.

    Attributes:
        values: swept values by key; empty for a reference.
        entries: estimates by column.
        reference: name of the reference, if it is one.
    """

    values: Mapping[str, Value]
    entries: Mapping[str, Estimate]
    reference: str = ""


@dataclass(frozen=True)
class Table:
    """Rows and columns.

    Attributes:
        title: name and unit of the metrics.
        keys: swept keys.
        columns: headings of the metrics.
        rows: configurations in the order of the sweep, then references.
        baseline: the row that the others are compared with, if any.
        named: headings of the keys, with their units.
    """

    title: str
    keys: list[str]
    columns: list[str]
    rows: list[Row]
    baseline: Row | None = None
    named: Mapping[str, str] = field(default_factory=dict)

    def change(self, row: Row, column: str) -> float | None:
        """Return the relative change from the baseline; None if there is none to compare."""
        if self.baseline is None or row is self.baseline or row.reference:
            return None
        usual = self.baseline.entries[column].mean
        change = row.entries[column].mean / usual - 1 if usual else math.nan
        return change if math.isfinite(change) else None


def tables_of(comparison: Comparison) -> list[Table]:
    """Return the configured tables, or by default one for each group of metrics (`position/…`)."""
    names = list(dict.fromkeys(name for job in comparison.jobs for name in job.metrics))
    groups = dict.fromkeys(name.rpartition("/")[0] for name in names)
    wanted = comparison.results.tables or [TableOf(f"{group}/*" if group else "*", group) for group in groups]
    matching = ((table, _matching(names, table.metrics)) for table in wanted)
    return [_table(comparison, table, columns) for table, columns in matching if columns]


def _matching(names: Sequence[str], pattern: str) -> list[str]:
    return [name for name in names if fnmatchcase(name, pattern) and name.count("/") == pattern.count("/")]


def _table(comparison: Comparison, wanted: TableOf, names: Sequence[str]) -> Table:
    units = comparison.results.with_unit
    headings = {name: units(name, heading) for name, heading in _headings(names).items()}
    groups: dict[tuple[tuple[str, Value], ...], list[Metrics]] = {}
    for job in comparison.jobs:
        entries = _entries(job.metrics, headings, wanted)
        groups.setdefault(tuple(job.values.items()), []).append(entries)
    columns = [*headings.values(), *_over_columns(wanted)]
    rows = [Row(dict(values), _estimates(group, columns)) for values, group in groups.items()]
    baseline = next((row for row in rows if _is_baseline(row, comparison.results.baseline)), None)
    references = [
        Row({}, _estimates([_entries(metrics, headings, wanted)], columns), name)
        for name, metrics in comparison.references.items()
        if metrics.keys() & headings.keys()
    ]
    keys = list(dict.fromkeys(key for row in rows for key in row.values))
    named = {key: units(key, key) for key in keys}
    return Table(wanted.title, keys, columns, [*rows, *references], baseline, named)


def _headings(names: Sequence[str]) -> dict[str, str]:
    """Return the names without the parts that all of them share."""
    parts = {name: name.split("/") for name in names}
    places = [place for place, words in enumerate(zip(*parts.values(), strict=True)) if len(set(words)) > 1]
    return {name: "/".join(words[place] for place in places) or name for name, words in parts.items()}


def _over_columns(wanted: TableOf) -> dict[str, Callable[[np.ndarray], Any]]:
    """Return the columns that are computed from the others."""
    possible: dict[str, tuple[bool, Callable[[np.ndarray], Any]]]
    possible = {VARIANCE: (wanted.variance, np.var), MEAN: (wanted.mean, np.mean)}
    return {name: function for name, (asked, function) in possible.items() if asked}


def _entries(metrics: Metrics, headings: Mapping[str, str], wanted: TableOf) -> Metrics:
    entries = {heading: metrics.get(name) for name, heading in headings.items()}
    values = np.array(list(entries.values()), dtype=float)
    return entries | {name: float(function(values)) for name, function in _over_columns(wanted).items()}


def _estimates(group: Sequence[Metrics], columns: Sequence[str]) -> dict[str, Estimate]:
    return {column: Estimate.of([entries[column] for entries in group]) for column in columns}


def _is_baseline(row: Row, values: Mapping[str, Value]) -> bool:
    return bool(values) and all(
        key in row.values and row.values[key] == value for key, value in values.items()
    )
