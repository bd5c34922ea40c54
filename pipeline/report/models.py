"""The scores of learned models: of the one that was trained, and of all that a sweep compared."""

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simgap.comparison.comparison import Comparison
from simgap.comparison.figure import FIGURE
from simgap.comparison.table import UNSWEPT, Row, tables_of
from simgap.comparison.table import Table as Compared
from simgap.report.inputs import ReportInputs, read_json
from simgap.report.section import Drawing, Section
from simgap.report.tables import Table, metric_tables
from simgap.report.text import NO_BREAK, estimate, is_number, number, percent, spoken

RESIDUALS = "residuals.svg"


def model_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Hold the errors of the trained model against those of persistence, and list its other scores."""
    metrics = read_json(inputs.train, "metrics.json")
    if not metrics:
        return None
    errors = {name: entry for name, entry in metrics.items() if _is_errors(entry)}
    others = {name: entry for name, entry in metrics.items() if name not in errors}
    content = {
        "errors": _errors_table(errors) if errors else None,
        "tables": metric_tables(others),
        "residuals": _picture(inputs.train, RESIDUALS),
    }
    return Section("model", "Trained model", content)


def sweeps_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Show what was compared, sweep by sweep, side by side."""
    sweeps = [_sweep(folder) for folder in inputs.sweeps]
    return Section("sweeps", "Models side by side", {"sweeps": sweeps}) if sweeps else None


def _is_errors(entry: Any) -> bool:
    return isinstance(entry, Mapping) and all(
        isinstance(pair, Mapping) and set(pair) == {"model", "naive"} for pair in entry.values()
    )


def _errors_table(errors: Mapping[str, Mapping[str, Any]]) -> Table:
    horizons = list(dict.fromkeys(horizon for entry in errors.values() for horizon in entry))
    rows = [
        [spoken(quantity), *(_against(entry[horizon]) if horizon in entry else "" for horizon in horizons)]
        for quantity, entry in errors.items()
    ]
    return Table("", ["", *map(_horizon, horizons)], rows)


def _horizon(name: str) -> str:
    """Write `h1` as 1 step and `h10` as 10 steps."""
    steps = name.removeprefix("h")
    return f"{steps} step{'s' if steps != '1' else ''}" if steps.isdigit() else name


def _against(pair: Mapping[str, Any]) -> str:
    model, naive = pair["model"], pair["naive"]
    change = (
        f"{NO_BREAK}({percent(model / naive - 1)})" if is_number(model) and is_number(naive) and naive else ""
    )
    return f"{number(model)}{change}"


def _sweep(folder: Path) -> dict[str, Any]:
    comparison = Comparison.read(folder)
    return {
        "title": comparison.results.title or spoken(comparison.name),
        "text": comparison.results.text,
        "command": comparison.command,
        "machine": comparison.machine,
        "tables": [_table(table) for table in tables_of(comparison)],
        "failed": comparison.failed,
        "picture": _picture(folder, FIGURE),
    }


def _picture(folder: Path | None, file: str) -> str | None:
    """Return a drawing, encoded; None where it is absent."""
    path = folder / file if folder is not None else None
    return base64.b64encode(path.read_bytes()).decode("ascii") if path and path.is_file() else None


def _table(table: Compared) -> Table:
    rows = [
        [_configuration(row), *(_entry(table, row, column) for column in table.columns)] for row in table.rows
    ]
    return Table(table.title, [", ".join(table.keys), *table.columns], rows)


def _configuration(row: Row) -> str:
    return row.reference or ", ".join(map(str, row.values.values())) or UNSWEPT


def _entry(table: Compared, row: Row, column: str) -> str:
    value, change = row.entries[column], table.change(row, column)
    text = estimate(value.mean, value.std)
    return text if change is None else f"{text}{NO_BREAK}({percent(change)})"
