"""Size of a model's residuals relative to its targets.

Source: Kantue & Pedro, grey-box modelling of multirotors in aggressive manoeuvres, P_f and P_i.
"""

import torch

from simgap.models.contract import DynamicsModel
from simgap.models.windows import Series


def ratios(measured: torch.Tensor, residual: torch.Tensor) -> dict[str, float]:
    """Return P_f = 1 − ‖ν‖/‖y − ȳ‖ and P_i = ‖y − ȳ‖/‖ν‖ − 1.

    Both are 0 where the mean would do as well, positive for a useful model and negative for one that is worse than the
    mean: P_f rises to 1 and falls without bound, P_i rises without bound and falls to −1. Kantue & Pedro take the
    sizes of both, so that a residual twice as large as the spread scores as well as none; here the sign is kept.

    Args:
        measured: y (samples,).
        residual: ν (samples,).
    """
    spread, left = torch.linalg.vector_norm(measured - measured.mean()), torch.linalg.vector_norm(residual)
    return {"P_f": float(1.0 - left / spread), "P_i": float(spread / left - 1.0)}


@torch.no_grad()
def residual_ratios(model: DynamicsModel, series: Series) -> dict[str, dict[str, float]]:
    """Return `ratios` of every target of one-step predictions, and under `size` what they took, where a fit told it.

    Raises:
        InputError: when the series has no window.
    """
    chunks = model.examples(series, "held-out").chunks()
    pairs = [
        (targets, targets - model.increments(windows.to(model.device)).to(targets))
        for windows, targets in chunks
    ]
    measured, residual = (torch.cat(part) for part in zip(*pairs, strict=True))
    found = {
        name: ratios(measured[:, index], residual[:, index])
        for index, name in enumerate(model.layout.targets)
    }
    return found | ({"size": model.size} if model.size else {})
