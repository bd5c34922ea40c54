"""Layouts whose states are rates alone: each moves by its own increment."""

from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.models.layout import Layout


@dataclass(frozen=True)
class RateLayout(Layout):
    """States and inputs side by side; what is predicted are the increments of all states."""

    @property
    def features(self) -> tuple[str, ...]:
        """States and inputs, in their units."""
        return (*self.states, *self.inputs)

    @property
    def targets(self) -> tuple[str, ...]:
        """Increments of the states, in their units."""
        return self.states

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """States and inputs side by side."""
        return torch.cat([state, action], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the changes of the states."""
        return following - state

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Return the next states."""
        return state + increment
