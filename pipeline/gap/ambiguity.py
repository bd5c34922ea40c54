"""Look-alikes: effects that a recording cannot tell apart."""

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

_DISTINCTION_LEVEL = 0.05  # level of the test between two effects
_STRICT_DISTINCTION_LEVEL = 0.01  # level where the catalogue calls the other one the likelier cause
_HALF = 0.5  # of the winner's share, above which another effect is a rival
_TWIN_SHARE = 0.9  # of the same, above which an equivalent description is one
_SAME_LOG_LIKELIHOOD = 1.0  # of log likelihood: "a bare mention" (Kass & Raftery 1995, Bayes factors)


@dataclass(frozen=True)
class Rivalry:
    """A named effect and its look-alikes, which explain the same residual about as well.

    Attributes:
        winner: the named effect.
        rivals: its look-alikes.
        weight: posterior weight of the winner among all of them, 0..1.
        others: the same of each look-alike.
    """

    winner: Effect
    rivals: tuple[Effect, ...]
    weight: float
    others: tuple[float, ...] = ()


def rivals_of(winner: Candidate, others: list[Candidate], cluster: Tensor) -> list[Candidate]:
    """Return the effects that predict about as well in the named effect's place.

    A rival explains at least half as much, and is not significantly worse than the winner (one-sided t test over
    clusters of correlated residuals). An equivalent description (`Effect.twins`) is a rival if it explains nearly as
    much. A rival with more parameters must predict better, too.
    """
    close = [
        o
        for o in others
        if _is_twin(winner, o) or (o.share > _HALF * winner.share and not predicts_better(winner, o, cluster))
    ]
    simple = len(winner.effect.parameters)
    return [o for o in close if len(o.effect.parameters) <= simple or total_score(o) > total_score(winner)]


def _is_twin(winner: Candidate, other: Candidate) -> bool:
    """Whether two effects are equivalent descriptions of the same law here."""
    return other.effect.name in winner.effect.twins and other.share > _TWIN_SHARE * winner.share


def rivalry_of(winner: Candidate, rivals: list[Candidate], cluster: Tensor) -> Rivalry | None:
    """Weigh a named effect against its rivals; None without rivals.

    The log evidence between two effects is half the squared t statistic of their difference over clusters, minus
    Schwarz's penalty per parameter.
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
    if abs(float(difference.sum())) < _SAME_LOG_LIKELIHOOD or len(difference) < 2:
        return 0.0
    statistic = float(stats.ttest_1samp(difference.numpy(), 0.0).statistic)
    return math.copysign(0.5 * statistic**2, statistic)


def total_score(candidate: Candidate) -> float:
    """Return the cross-validated log likelihood of a simulator with a candidate, up to a constant."""
    return float(candidate.score.sum())


def predicts_better(first: Candidate, second: Candidate, cluster: Tensor) -> bool:
    """Return whether one candidate predicts significantly better than another, over clusters of residuals."""
    strict = second.effect.name in first.effect.yields_to
    return is_beyond_chance(
        _difference(first, second, cluster), _STRICT_DISTINCTION_LEVEL if strict else _DISTINCTION_LEVEL
    )


def is_beyond_chance(ahead: Tensor, chance: float = _DISTINCTION_LEVEL) -> bool:
    """Return whether a gain in log likelihood per cluster is significantly positive.

    Args:
        ahead: log likelihood minus that of the other, (clusters,).
        chance: level of the one-sided t test.
    """
    if abs(float(ahead.sum())) < _SAME_LOG_LIKELIHOOD:
        return False
    return float(stats.ttest_1samp(ahead.numpy(), 0.0, alternative="greater").pvalue) <= chance


def is_as_good(score: Tensor, other: Tensor) -> bool:
    """Return whether a log likelihood (clusters,) is less than another by under 1 in all: no evidence."""
    return float((other - score).sum()) < _SAME_LOG_LIKELIHOOD


def _difference(first: Candidate, second: Candidate, cluster: Tensor) -> Tensor:
    """Return by how much the log likelihood of the first exceeds the second's in each cluster, (clusters,)."""
    difference = first.score - second.score
    return difference.new_zeros(int(cluster.max()) + 1).index_add(0, cluster, difference)
