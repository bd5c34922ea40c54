"""Tables out of nested mappings: identified parameters and metrics, whatever their names are."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from simgap.report.text import estimate, is_number, pretty_unit, short, spoken

_VALUE_KEYS = ("value", "estimate")
_ERROR_KEYS = ("std", "standard_error")
_ABBREVIATIONS = {"mse": "MSE", "mae": "MAE", "rmse": "RMSE", "rms": "RMS", "r2": "R²"}


@dataclass(frozen=True)
class Table:
    """A table: heading, names of the columns, rows of cells as text."""

    title: str
    columns: list[str]
    rows: list[list[str]]


def metric_tables(metrics: Mapping[str, Any], title: str = "") -> list[Table]:
    """Lay out metrics: plain numbers as one list, groups with common keys as a row each."""
    plain = {key: value for key, value in metrics.items() if not isinstance(value, Mapping | list)}
    groups = {key: value for key, value in metrics.items() if isinstance(value, Mapping) and value}
    flat = {
        key: group for key, group in groups.items() if not any(isinstance(v, Mapping) for v in group.values())
    }
    tables = []
    if plain:
        tables.append(
            Table(title, ["metric", "value"], [[_metric(key), cell(value)] for key, value in plain.items()])
        )
    if flat:
        columns = list(dict.fromkeys(key for group in flat.values() for key in group))
        rows = [
            [_metric(key), *(cell(group[column]) if column in group else "" for column in columns)]
            for key, group in flat.items()
        ]
        tables.append(Table(title, ["", *map(_metric, columns)], rows))
    for key, group in groups.items():
        if key not in flat:
            tables += metric_tables(group, " · ".join(filter(None, [title, spoken(key)])))
    return tables


def parameter_rows(parameters: Any, name: str = "") -> list[dict[str, str]]:
    """List every estimate in a nested mapping: its full name, `value ± std unit` and what it was before."""
    if isinstance(parameters, Mapping):
        value_key = next((key for key in _VALUE_KEYS if key in parameters), None)
        if value_key is not None and not isinstance(parameters[value_key], Mapping):
            return _estimates(parameters, value_key, name)
        return [
            row
            for key, entry in parameters.items()
            for row in parameter_rows(entry, " · ".join(filter(None, [name, spoken(key)])))
        ]
    return [{"name": name, "value": cell(parameters), "nominal": "", "note": ""}]


def cell(value: Any) -> str:
    """Write one value of a table."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}".replace(",", "\u202f")
    if isinstance(value, float):
        return short(value, 4) if is_number(value) else "–"
    return ", ".join(map(cell, value)) if isinstance(value, list) else str(value)


def _metric(name: str) -> str:
    words = spoken(name).replace("r squared", "r2").split(" ")
    return " ".join(_ABBREVIATIONS.get(word.lower(), word) for word in words)


def _estimates(entry: Mapping[str, Any], value_key: str, name: str) -> list[dict[str, str]]:
    value, unit = entry[value_key], entry.get("unit") or ""
    std = next((entry[key] for key in _ERROR_KEYS if key in entry), None)
    nominal = entry.get("nominal")
    many = isinstance(value, list)
    values = value if many else [value]
    stds = std if isinstance(std, list) else [std] * len(values)
    nominals = nominal if isinstance(nominal, list) else [nominal] * len(values)
    rows = zip(values, stds, nominals, strict=True)
    return [
        {
            "name": f"{name} {index}" if many else name,
            "value": estimate(one, error, unit) if is_number(one) else cell(one),
            "nominal": "" if before is None else f"{cell(before)} {pretty_unit(unit)}".strip(),
            "note": str(entry.get("note") or ""),
        }
        for index, (one, error, before) in enumerate(rows, start=1)
    ]
