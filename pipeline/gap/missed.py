"""Whether a hypothesis misses a part of a recording."""

from simgap.gap.hypothesis import Hypothesis

_LEAST = 1e-3
"""The least share of blocks with a discrepancy that the likelihood knows: hardly any."""


def misses(hypothesis: Hypothesis) -> bool:
    """Whether a hypothesis leaves more than noise: some channel has blocks that hold a discrepancy.

    A few blocks that are missed tell already that something else is there.
    """
    likelihood, temper = hypothesis.likelihood, hypothesis.reading.likelihood_of.temper
    return bool((temper.mixture(likelihood.left, likelihood.noise).share > _LEAST).any())
