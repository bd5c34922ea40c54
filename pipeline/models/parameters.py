"""Identified parameters, as a person reads them."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

WITHHELD = "not observable: "
"""How the note of a parameter begins that this recording does not tell."""


@dataclass(frozen=True)
class Parameter:
    """One identified parameter.

    Attributes:
        value: the estimate; None where the recording cannot tell it.
        unit: of the value.
        standard_error: of the value, in its unit; None where it cannot be had.
        nominal: what the platform says; None where it says nothing.
        note: what a person has to know to use it, one sentence.
    """

    value: float | None
    unit: str
    standard_error: float | None = None
    nominal: float | None = None
    note: str = ""

    def as_mapping(self) -> dict[str, Any]:
        """Return what is written to `parameters.yaml`."""
        return {
            "value": _rounded(self.value),
            "standard_error": _rounded(self.standard_error),
            "unit": self.unit,
            "nominal": self.nominal,
            "note": self.note,
        }


def write_parameters(parameters: dict[str, Any], path: Path) -> None:
    """Write a tree of parameters as YAML, in the order given."""
    text = yaml.safe_dump(_plain(parameters), sort_keys=False, allow_unicode=True, width=110)
    path.write_text(text, encoding="utf-8")


def _plain(entry: Any) -> Any:
    if isinstance(entry, Parameter):
        return entry.as_mapping()
    return {key: _plain(value) for key, value in entry.items()} if isinstance(entry, dict) else entry


def _rounded(value: float | None) -> float | None:
    """Keep eight digits: the rest is rounding of the arithmetic."""
    return float(f"{value:.8g}") if value is not None and math.isfinite(value) else None
