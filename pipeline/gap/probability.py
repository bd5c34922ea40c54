"""How sure a name is: the probability that is written beside it."""

import math

from pipeline.gap.name import Candidate

_PRIOR = 0.1
_MOST = 0.995


def probability_of(candidate: Candidate, clusters: int, uniqueness: float, steadiness: float) -> float:
    """Return the probability that an effect is present.

    The evidence is the Schwarz approximation of the Bayes factor on the number of independent clusters, against a prior
    of one effect in ten; it is multiplied by the chance that it is this effect and not a rival, and by how steady its
    parameters are over the runs.
    Source: Kass & Raftery 1995, Bayes factors (JASA 90), eq. 9.

    Args:
        candidate: the named effect, judged as the last to enter.
        clusters: number of stretches with independent residuals.
        uniqueness: posterior weight among its rivals, 1 where there are none.
        steadiness: 0..1, see `pipeline.gap.model.steadiness`.
    """
    penalty = 0.5 * len(candidate.effect.parameters) * math.log(max(clusters, 2))
    log_odds = candidate.gain - penalty + math.log(_PRIOR / (1.0 - _PRIOR))
    evidence = 1.0 / (1.0 + math.exp(-max(min(log_odds, 50.0), -50.0)))
    return min(evidence * uniqueness * steadiness, _MOST)
