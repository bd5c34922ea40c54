"""Effects that a recording cannot tell apart."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import torch
from scipy import stats
from torch import Tensor

from pipeline.gap.scoring import log_score

if TYPE_CHECKING:
    from pipeline.effects import Effect
    from pipeline.gap.candidate import Candidate

_CHANCE = 0.05
_HALF = 0.5


@dataclass(frozen=True)
class Rivalry:
    """A named effect and those that explain the same residual about as well.

    Attributes:
        winner: what was named.
        rivals: what could stand in for it.
        weight: posterior weight of the winner among them all, 0..1.
    """

    winner: Effect
    rivals: tuple[Effect, ...]
    weight: float


def rivals_of(winner: Candidate, others: list[Candidate], cluster: Tensor) -> list[Candidate]:
    """Return the others that predict about as well in the named effect's place.

    An other is a rival when it explains at least half as much and the difference to the winner, taken over clusters of
    correlated residuals, is within chance (one-sided t test).
    """
    return [o for o in others if o.share > _HALF * winner.share and not predicts_better(winner, o, cluster)]


def rivalry_of(winner: Candidate, rivals: list[Candidate], clusters: int) -> Rivalry | None:
    """Weigh a named effect against its rivals by how each predicts and how many parameters it takes; None without any.

    All are weighed on the winner's count of independent rows, since they explain the same residual.
    """
    if not rivals:
        return None
    penalty = 0.5 * math.log(max(clusters, 2))
    evidence = [
        total_score(c) / winner.design_effect - penalty * len(c.effect.parameters) for c in (winner, *rivals)
    ]
    weight = float(torch.softmax(torch.tensor(evidence, dtype=torch.float64), dim=0)[0])
    return Rivalry(winner.effect, tuple(rival.effect for rival in rivals), weight)


def total_score(candidate: Candidate) -> float:
    """Return the cross-validated log likelihood of a simulator with a candidate, up to a constant."""
    return float(log_score(candidate.residual, candidate.fit.scale).sum())


def predicts_better(first: Candidate, second: Candidate, cluster: Tensor) -> bool:
    """Return whether one candidate predicts better than another beyond chance, taken over clusters of residuals."""
    difference = log_score(first.residual, first.fit.scale) - log_score(second.residual, second.fit.scale)
    groups = int(cluster.max()) + 1
    summed = difference.new_zeros(groups).index_add(0, cluster, difference)
    if float(summed.abs().max()) < 1e-9:
        return False
    return float(stats.ttest_1samp(summed.numpy(), 0.0, alternative="greater").pvalue) <= _CHANCE
