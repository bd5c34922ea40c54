"""Shift and scale of features and increments."""

from dataclasses import dataclass

import torch
from torch import Tensor

from pipeline.errors import InputError

SCALINGS = ("standard", "robust")


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

    def apply(self, values: Tensor) -> Tensor:
        """Return scaled values."""
        return (values - self.centre) / self.spread

    def undo(self, values: Tensor) -> Tensor:
        """Return values in their own units."""
        return values * self.spread + self.centre
