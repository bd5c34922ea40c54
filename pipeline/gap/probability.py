"""How sure a name is: the probability that is written beside it, and the features that it is made of."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

CALIBRATION = Path(__file__).with_name("calibration.yaml")
"""Where the coefficients of the features are."""

DIRECTIONS = {
    "evidence": 1,
    "unsteadiness": -1,
    "signal": 1,
    "excess": -1,
    "number": -1,
}
"""Whether more of a feature speaks for the effect (+1) or against it (−1)."""

_GREATEST_PROBABILITY = 0.995  # nothing is certain of one recording
_REFUTED = 0.25  # and a name is less likely than not where other runs speak against it
_OPEN = 0.5  # and no likelier than not where samples are too far apart to tell it from others
_LEAST_SIGNAL, _MOST_SIGNAL = 0.01, 1.0  # times the noise: what cannot hide in it may be as small as it is
_MOST_EXCESS = 10.0  # times the noise, whose level says little where far more is left
_SLIGHT_RATIO = (
    30.0  # times its share of what is explained, up to which what is left counts: a thirtieth is slight
)
_MOST_ODDS = 50.0  # of the logarithm, beyond which the exponential says nothing more


@dataclass(frozen=True)
class Features:
    """What speaks for a named effect and against it.

    Attributes:
        gain: cross-validated log likelihood gained by the effect as the last to enter, for independent rows.
        parameters: how many it has.
        clusters: number of stretches with independent residuals.
        unsteadiness: greatest certain drift of its parameters between runs, over their values.
        signal: energy that it explains over the noise's, in the channel where it explains most.
        excess: energy that is left beside it there over the noise's.
        is_number: whether it is a wrong number of the platform, which bends to much that it is not, and no law.
        kind: of platform; names are not as often right for every kind.
        weight: of the effect among those that this recording cannot tell from it.
        coarse: whether samples are too far apart to show how what it acts on moves, and more than noise is left there.
        refuted: whether runs that were used for nothing else are predicted worse with what was named, beyond noise.
    """

    gain: float
    parameters: int
    clusters: int
    unsteadiness: float = 0.0
    signal: float = 1.0
    excess: float = 1.0
    is_number: bool = False
    kind: str = ""
    weight: float = 1.0
    coarse: bool = False
    refuted: bool = False

    @property
    def log_bayes_factor(self) -> float:
        """The evidence for the effect: the Schwarz approximation on the number of independent clusters.

        Source: Kass & Raftery 1995, Bayes factors (JASA 90), eq. 9.
        """
        return self.gain - 0.5 * self.parameters * math.log(max(self.clusters, 2))

    @property
    def _most_excess(self) -> float:
        """Up to which energy left counts: what is little beside all that the effect explains says little against it."""
        return min(_MOST_EXCESS, 1.0 + _SLIGHT_RATIO * self.excess / max(self.signal, _LEAST_SIGNAL))

    @property
    def scaled(self) -> dict[str, float]:
        """The features on scales on which their differences count alike, by the names of `DIRECTIONS`."""
        return {
            "evidence": math.asinh(self.log_bayes_factor),
            "unsteadiness": math.log1p(self.unsteadiness),
            "signal": math.log10(min(max(self.signal, _LEAST_SIGNAL), _MOST_SIGNAL)),
            "excess": math.log10(max(min(self.excess, self._most_excess), 1.0)),
            "number": float(self.is_number),
        }


@dataclass(frozen=True)
class Calibration:
    """A logistic regression of how often names are right (`simgap calibrate`).

    Attributes:
        intercept: of all kinds of platform.
        coefficients: by feature.
        offsets: of the intercept, by kind of platform.
    """

    intercept: float
    coefficients: dict[str, float]
    offsets: dict[str, float]

    def presence(self, features: Mapping[str, float], kind: str) -> float:
        """Return the probability of an effect with these features on a platform of this kind."""
        odds = self.intercept + self.offsets.get(kind, 0.0)
        odds += sum(self.coefficients[name] * features[name] for name in DIRECTIONS)
        return 1.0 / (1.0 + math.exp(-max(min(odds, _MOST_ODDS), -_MOST_ODDS)))


def presence_of(features: Features) -> float:
    """Return the probability that an effect of this kind is there, whichever of its rivals it is."""
    most = _REFUTED if features.refuted else _OPEN if features.coarse else _GREATEST_PROBABILITY
    return min(_calibration().presence(features.scaled, features.kind), most)


def probability_of(features: Features) -> float:
    """Return the probability that it is this effect: present, and none of those that cannot be told from it."""
    return presence_of(features) * features.weight


@cache
def _calibration() -> Calibration:
    """Return what was fitted to concealed cases."""
    content = yaml.safe_load(CALIBRATION.read_text(encoding="utf-8"))
    return Calibration(content["intercept"], content["coefficients"], content["offsets"])
