"""How sure a name is: the probability that is written beside it."""

import math
from collections.abc import Sequence

from pipeline.gap.model import Drift, steadiness

_PRIOR = 0.1
_MOST = 0.995


def presence_of(gain: float, parameters: int, clusters: int, drifts: Sequence[Drift]) -> float:
    """Return the probability that an effect is present, if none of its rivals is.

    The evidence is the Schwarz approximation of the Bayes factor on the number of independent clusters, against a prior
    of one effect in ten; it is lowered by how much the effect's parameters certainly drift between runs.
    Source: Kass & Raftery 1995, Bayes factors (JASA 90), eq. 9.

    Args:
        gain: cross-validated log likelihood gained by the effect as the last to enter.
        parameters: how many it has.
        clusters: number of stretches with independent residuals.
        drifts: of its parameters between runs.
    """
    penalty = 0.5 * parameters * math.log(max(clusters, 2))
    log_odds = gain - penalty + math.log(_PRIOR / (1.0 - _PRIOR))
    evidence = 1.0 / (1.0 + math.exp(-max(min(log_odds, 50.0), -50.0)))
    return min(evidence * steadiness(drifts), _MOST)
