"""Machines that misjudge their states as the drawn residuals say; see `simgap.policies.racing.racing.Misjudging`."""

import torch
from torch import Tensor

from simgap.policies.residual.beliefs import state_features, with_residual
from simgap.policies.residual.realisations import Realisations


class DrawnMisjudging:
    """Each machine misjudges its state by one of the drawn functions of it and of time."""

    def __init__(self, drawn: Realisations, device: torch.device | str = "cpu") -> None:
        self._drawn = drawn.to(device)

    def __len__(self) -> int:
        """Return how many functions were drawn."""
        return len(self._drawn)

    def __call__(self, state: dict[str, Tensor], moments: Tensor, which: Tensor) -> dict[str, Tensor]:
        """Return what is believed of states, each part (batch, ...), at moments (batch,) s of functions (batch,)."""
        return with_residual(state, self._drawn(state_features(state), moments, which))
