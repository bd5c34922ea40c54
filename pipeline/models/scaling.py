"""Shift and scale of features and increments."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.errors import InputError

SCALINGS = ("standard", "robust")
_SCALER_PARTS = ("centre", "spread")


@dataclass(frozen=True)
class Scaler:
    """An affine map that brings each column to about zero mean and unit spread.

    Attributes:
        centre: (columns,).
        spread: (columns,); one where the column does not vary.
    """

    centre: Tensor
    spread: Tensor

    @classmethod
    def fit(cls, values: Tensor, scaling: str) -> "Scaler":
        """Fit to values (samples, columns).

        Args:
            values: to be scaled.
            scaling: `standard` (mean, standard deviation) or `robust` (median, interquartile range).

        Raises:
            InputError: on another scaling.
        """
        if scaling not in SCALINGS:
            raise InputError(f"unknown scaling {scaling!r}", "model.scaling", f"use {' or '.join(SCALINGS)}")
        if scaling == "robust":
            order = values.sort(dim=0).values
            low, centre, high = (order[round(share * (len(values) - 1))] for share in (0.25, 0.5, 0.75))
            spread = high - low
        else:
            centre, spread = values.mean(0), values.std(0)
        # Columns that hardly vary between the quartiles, or not at all, keep a scale that cannot blow up.
        usual = values.std(0)
        spread = torch.where(spread > 0.1 * usual, spread, usual)
        floor = 1e-9 * (1.0 + centre.abs())
        return cls(centre, torch.where(spread > floor, spread, torch.ones_like(spread)))

    def to(self, device: torch.device) -> "Scaler":
        """Return the same scaler on a device."""
        return Scaler(self.centre.to(device), self.spread.to(device))

    def apply(self, values: Tensor) -> Tensor:
        """Return scaled values."""
        return (values - self.centre) / self.spread

    def undo(self, values: Tensor) -> Tensor:
        """Return values in their own units."""
        return values * self.spread + self.centre


def scaler_tensors(inputs: Scaler, outputs: Scaler) -> dict[str, Tensor]:
    """Return the tensors of a model's two scalers by name."""
    pairs = (("inputs", inputs), ("outputs", outputs))
    return {f"{name}.{part}": getattr(scaler, part) for name, scaler in pairs for part in _SCALER_PARTS}


def scaler_shapes(features: int, targets: int) -> dict[str, tuple[int, ...]]:
    """Return the shapes of what `scaler_tensors` returns for so many features and targets."""
    columns = (("inputs", features), ("outputs", targets))
    return {f"{name}.{part}": (count,) for name, count in columns for part in _SCALER_PARTS}


def scalers_of(tensors: Mapping[str, Tensor]) -> tuple[Scaler, Scaler]:
    """Return the scalers of inputs and outputs whose tensors `scaler_tensors` returned."""
    inputs, outputs = (
        Scaler(*(tensors[f"{name}.{part}"] for part in _SCALER_PARTS)) for name in ("inputs", "outputs")
    )
    return inputs, outputs
