"""Effects that a recording cannot tell apart."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import torch
from scipy import stats
from torch import Tensor

if TYPE_CHECKING:
    from simgap.effects import Effect
    from simgap.gap.candidate import Candidate

_CHANCE = 0.05
_STRICT_CHANCE = 0.01  # where the catalogue calls the other the likelier cause
_HALF = 0.5
_NEARLY = 0.9
_SAME = 1.0  # of a log likelihood: "not worth more than a bare mention" (Kass & Raftery 1995, Bayes factors)


@dataclass(frozen=True)
class Rivalry:
    """A named effect and those that explain the same residual about as well.

    Attributes:
        winner: what was named.
        rivals: what could stand in for it.
        weight: posterior weight of the winner among them all, 0..1.
        others: the same of each rival.
    """

    winner: Effect
    rivals: tuple[Effect, ...]
    weight: float
    others: tuple[float, ...] = ()


def rivals_of(winner: Candidate, others: list[Candidate], cluster: Tensor) -> list[Candidate]:
    """Return the others that predict about as well in the named effect's place.

    An other is a rival when it explains at least half as much and the difference to the winner, taken over clusters of
    correlated residuals, is within chance (one-sided t test); one that says the same in other words is, when it
    explains nearly as much. One with more parameters has to predict better, too.
    """
    close = [
        o
        for o in others
        if _is_twin(winner, o) or (o.share > _HALF * winner.share and not predicts_better(winner, o, cluster))
    ]
    simple = len(winner.effect.parameters)
    return [o for o in close if len(o.effect.parameters) <= simple or total_score(o) > total_score(winner)]


def _is_twin(winner: Candidate, other: Candidate) -> bool:
    """Whether one says what the other says, in other words."""
    return other.effect.name in winner.effect.twins and other.share > _NEARLY * winner.share


def rivalry_of(winner: Candidate, rivals: list[Candidate], cluster: Tensor) -> Rivalry | None:
    """Weigh a named effect against its rivals by how each predicts and how many parameters it takes; None without any.

    The evidence between two is that of their mean difference over clusters of correlated residuals, half its squared
    t statistic, and Schwarz's penalty for each parameter.
    """
    if not rivals:
        return None
    penalty = 0.5 * math.log(max(int(cluster.max()) + 1, 2))
    evidence = [0.0] + [
        _evidence_for(rival, winner, cluster)
        - penalty * (len(rival.effect.parameters) - len(winner.effect.parameters))
        for rival in rivals
    ]
    weight, *others = torch.softmax(torch.tensor(evidence, dtype=torch.float64), dim=0).tolist()
    return Rivalry(winner.effect, tuple(rival.effect for rival in rivals), weight, tuple(others))


def _evidence_for(first: Candidate, second: Candidate, cluster: Tensor) -> float:
    difference = _difference(first, second, cluster)
    if _is_twin(second, first):
        return 0.0
    if abs(float(difference.sum())) < _SAME or len(difference) < 2:
        return 0.0
    statistic = float(stats.ttest_1samp(difference.numpy(), 0.0).statistic)
    return math.copysign(0.5 * statistic**2, statistic)


def total_score(candidate: Candidate) -> float:
    """Return the cross-validated log likelihood of a simulator with a candidate, up to a constant."""
    return float(candidate.score.sum())


def predicts_better(first: Candidate, second: Candidate, cluster: Tensor) -> bool:
    """Return whether one candidate predicts better than another beyond chance, taken over clusters of residuals."""
    strict = second.effect.name in first.effect.yields_to
    return is_beyond_chance(_difference(first, second, cluster), _STRICT_CHANCE if strict else _CHANCE)


def is_beyond_chance(ahead: Tensor, chance: float = _CHANCE) -> bool:
    """Return whether log likelihoods ahead of another's, summed over clusters of residuals, are so by more than chance.

    Args:
        ahead: (clusters,).
        chance: of a one-sided t test.
    """
    if abs(float(ahead.sum())) < _SAME:
        return False
    return float(stats.ttest_1samp(ahead.numpy(), 0.0, alternative="greater").pvalue) <= chance


def is_as_good(score: Tensor, other: Tensor) -> bool:
    """Return whether a log likelihood, summed over clusters (clusters,), falls behind another by a bare mention."""
    return float((other - score).sum()) < _SAME


def _difference(first: Candidate, second: Candidate, cluster: Tensor) -> Tensor:
    """Return by how much the log likelihood of the first exceeds the second's in each cluster, (clusters,)."""
    difference = first.score - second.score
    return difference.new_zeros(int(cluster.max()) + 1).index_add(0, cluster, difference)
