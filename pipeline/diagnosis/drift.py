"""Drift of fitted parameters between runs: a sign that an effect absorbs another one."""

import math
from dataclasses import dataclass

import torch
from scipy import stats

from simgap.effects import Effect
from simgap.equations.fit import Fit, columns_of, inverse_of
from simgap.simulation.blocks import Blocks

_DRIFT_CHANCE = 1e-3
_LEAST_DISTANCE = 0.2  # of a value; the least distance from neutral that a drift is related to
_TOLERATED_DRIFT = 0.25  # of the value; runs of one machine differ by this much without another cause


@dataclass(frozen=True)
class Drift:
    """The spread of a parameter between runs that are fitted one by one.

    Attributes:
        parameter: its name.
        spread: standard deviation between runs beyond what its errors explain, over how far the value is from doing
            nothing, or over a part of the value where that is more.
        p_value: of the runs agreeing (Cochran's Q).
    """

    parameter: str
    spread: float
    p_value: float

    @property
    def notable(self) -> bool:
        """Whether the drift is both certain and large."""
        return self.p_value < _DRIFT_CHANCE and self.spread > _TOLERATED_DRIFT


def drifts_of(fit: Fit, effect: Effect, blocks: Blocks, cluster: torch.Tensor) -> list[Drift]:
    """Compare an effect's parameters between the runs, the other effects held.

    An effect that absorbs another effect's residual has no constant value: its parameter follows the manoeuvre.
    Source: Cochran 1954, The combination of estimates from different experiments (Biometrics 10).
    """
    columns = columns_of(fit, effect)
    attempts = (_estimate(fit, columns, blocks.run == run, cluster) for run in torch.unique(blocks.run))
    estimates = [estimate for estimate in attempts if estimate is not None]
    drifts = []
    for position, parameter in enumerate(effect.parameters):
        pairs = [(values[position], errors[position]) for values, errors in estimates if errors[position] > 0]
        if len(pairs) >= 3:
            value = float(fit.values[columns[position]])
            distance = max(abs(value - parameter.neutral), _LEAST_DISTANCE * abs(value))
            drifts.append(_heterogeneity(parameter.name, pairs, distance))
    return drifts


def _estimate(
    fit: Fit, columns: list[int], mine: torch.Tensor, cluster: torch.Tensor
) -> tuple[list[float], list[float]] | None:
    """Return value and robust error of some parameters on one run, or None where it holds too few clusters."""
    groups = torch.unique(cluster[mine], return_inverse=True)[1]
    count = int(groups.max()) + 1
    if count < 4:
        return None
    scale = fit.residual.square().mean((0, 1)).sqrt().clamp_min(1e-12)
    jacobian = fit.jacobian[mine][..., columns] / scale[..., None]
    residual = fit.residual[mine] / scale
    gram = torch.einsum("brcp,brcq->pq", jacobian, jacobian)
    bread = inverse_of(gram)
    change = bread @ torch.einsum("brcp,brc->p", jacobian, residual)
    score = torch.einsum("brcp,brc->bp", jacobian, residual - jacobian @ change)
    summed = score.new_zeros((count, len(columns))).index_add(0, groups, score)
    covariance = bread @ (summed.T @ summed) @ bread * (count / (count - 1))
    # What shows in one cluster of a run only is fitted there without a residual: its robust error would be none.
    variance = torch.maximum(covariance.diagonal(), bread.diagonal())
    return (fit.values[columns] + change).tolist(), variance.clamp_min(0).sqrt().tolist()


def _heterogeneity(name: str, pairs: list[tuple[float, float]], distance: float) -> Drift:
    values = torch.tensor([value for value, _ in pairs], dtype=torch.float64)
    weights = torch.tensor([error**-2 for _, error in pairs], dtype=torch.float64)
    mean = (weights * values).sum() / weights.sum()
    q = float((weights * (values - mean) ** 2).sum())
    freedom = len(pairs) - 1
    # DerSimonian & Laird's moment estimate of the variance between runs.
    others = float(weights.sum() - (weights**2).sum() / weights.sum())
    between = max(q - freedom, 0.0) / others if others > 0 else 0.0
    spread = math.sqrt(between) / max(distance, 1e-12)
    return Drift(name, spread, float(stats.chi2.sf(q, freedom)))
