"""Size of a model's residuals relative to its targets."""

import torch

from simgap.models.contract import DynamicsModel
from simgap.models.windows import Series


def ratios(measured: torch.Tensor, residual: torch.Tensor) -> dict[str, float]:
    """Return P_f = |1 − ‖ν‖/‖y − ȳ‖| and P_i = |1 − ‖y − ȳ‖/‖ν‖|.

    For a useful model P_f rises from 0, where the mean would do as well, to 1; P_i grows without bound.

    Args:
        measured: y (samples,).
        residual: ν (samples,).
    """
    spread, left = torch.linalg.vector_norm(measured - measured.mean()), torch.linalg.vector_norm(residual)
    return {"P_f": float((1.0 - left / spread).abs()), "P_i": float((1.0 - spread / left).abs())}


@torch.no_grad()
def residual_ratios(model: DynamicsModel, series: Series) -> dict[str, dict[str, float]]:
    """Return `ratios` of every target of one-step predictions, and under `size` what they took, where a fit told it.

    Raises:
        InputError: when the series has no window.
    """
    chunks = model.examples(series, "held-out").chunks()
    pairs = [(targets, targets - model.increments(windows)) for windows, targets in chunks]
    measured, residual = (torch.cat(part) for part in zip(*pairs, strict=True))
    found = {
        name: ratios(measured[:, index], residual[:, index])
        for index, name in enumerate(model.layout.targets)
    }
    return found | ({"size": model.size} if model.size else {})
