"""What is believed after a search: averages over every hypothesis that it visited."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from simgap.effects import Effect
from simgap.gap.hypothesis import Hypothesis

_RIVAL = 0.05
"""Least probability of a name that is said to be a rival of another one."""
_TOGETHER = 0.5
"""Of the probability that two independent names would have together: below, one takes the other's place."""


@dataclass(frozen=True)
class Posterior:
    """Probabilities by model averaging.

    Attributes:
        hypotheses: visited, the most probable first.
        weights: of each, summing to one.
    """

    hypotheses: tuple[Hypothesis, ...]
    weights: tuple[float, ...]

    @property
    def best(self) -> Hypothesis:
        """The most probable hypothesis."""
        return self.hypotheses[0]

    def best_with(self, key: str) -> Hypothesis:
        """Return the most probable hypothesis that names an effect."""
        return next(hypothesis for hypothesis in self.hypotheses if key in hypothesis.names)

    def effect(self, key: str) -> Effect:
        """Return an effect that some hypothesis names."""
        return next(f.effect for f in self.best_with(key).fit.simulator.free if f.effect.key == key)

    def inclusion(self) -> dict[str, float]:
        """Return the probability of each effect being there, by key, the most probable first.

        Source: Hoeting et al. 1999, Bayesian model averaging: a tutorial (Statistical Science 14).
        """
        found: dict[str, float] = {}
        for hypothesis, weight in zip(self.hypotheses, self.weights, strict=True):
            for key in hypothesis.names:
                found[key] = found.get(key, 0.0) + weight
        return dict(sorted(found.items(), key=lambda item: (-item[1], item[0])))

    def together(self, first: str, second: str) -> float:
        """Return the probability of two effects being there at once."""
        pairs = zip(self.hypotheses, self.weights, strict=True)
        return sum((weight for hypothesis, weight in pairs if {first, second} <= hypothesis.names), 0.0)

    def rivals(self) -> list[tuple[str, str]]:
        """Return pairs of effects of which one is there and hardly both: a recording cannot tell them apart."""
        inclusion = {key: p for key, p in self.inclusion().items() if _RIVAL <= p <= 1.0 - _RIVAL}
        return [
            (first, second)
            for first, second in combinations(inclusion, 2)
            if self.together(first, second) < _TOGETHER * inclusion[first] * inclusion[second]
        ]


def posterior_of(hypotheses: Sequence[Hypothesis]) -> Posterior:
    """Return the posterior over visited hypotheses, by their scores."""
    ranked = sorted(hypotheses, key=lambda hypothesis: -hypothesis.score)
    weights = [math.exp(hypothesis.score - ranked[0].score) for hypothesis in ranked]
    total = sum(weights)
    return Posterior(tuple(ranked), tuple(weight / total for weight in weights))
