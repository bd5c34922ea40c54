"""The probability of a named effect: a calibrated logistic regression of features."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

CALIBRATION = Path(__file__).with_name("calibration.yaml")
"""The file of the coefficients."""

DIRECTIONS = {
    "evidence": 1,
    "unsteadiness": -1,
    "signal": 1,
    "excess": -1,
    "number": -1,
}
"""Whether more of a feature speaks for the effect (+1) or against it (−1)."""

_GREATEST_PROBABILITY = 0.995  # cap of every probability
_REFUTED = 0.25  # cap where held-out runs contradict the named effects
_OPEN = 0.5  # cap where the axis is sampled too coarsely
_LEAST_SIGNAL, _MOST_SIGNAL = 0.01, 1.0  # limits of the signal, times the noise energy
_MOST_EXCESS = 10.0  # limit of the excess, times the noise energy
_SLIGHT_RATIO = 30.0  # limit of the excess, as a multiple of excess over signal
_MOST_ODDS = 50.0  # limit of the log odds, against overflow


@dataclass(frozen=True)
class Features:
    """The features of a named effect.

    Attributes:
        gain: gain in cross-validated log likelihood as the last effect to enter, divided by the design effect.
        parameters: number of its parameters.
        clusters: number of clusters with independent residuals.
        unsteadiness: greatest significant drift of its parameters between runs, over their values.
        signal: energy that it explains over the noise energy, in the channel where it explains most.
        excess: energy that is left there over the noise energy.
        is_number: whether it is an error of a platform number, which adapts to many other causes.
        kind: kind of platform.
        weight: posterior weight of the effect among its look-alikes.
        coarse: whether its axis is sampled too coarsely and more than noise is left there.
        refuted: whether the named effects make the prediction of held-out runs worse, beyond noise.
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
        """Upper limit of the excess: a rest that is small against what the effect explains counts little."""
        return min(_MOST_EXCESS, 1.0 + _SLIGHT_RATIO * self.excess / max(self.signal, _LEAST_SIGNAL))

    @property
    def scaled(self) -> dict[str, float]:
        """The features on the scales of the regression, by the names of `DIRECTIONS`."""
        return {
            "evidence": math.asinh(self.log_bayes_factor),
            "unsteadiness": math.log1p(self.unsteadiness),
            "signal": math.log10(min(max(self.signal, _LEAST_SIGNAL), _MOST_SIGNAL)),
            "excess": math.log10(max(min(self.excess, self._most_excess), 1.0)),
            "number": float(self.is_number),
        }


@dataclass(frozen=True)
class Calibration:
    """A logistic regression of the presence of named effects (`simgap calibrate`).

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
    """Return the probability that the effect or one of its look-alikes is present."""
    most = _REFUTED if features.refuted else _OPEN if features.coarse else _GREATEST_PROBABILITY
    return min(_calibration().presence(features.scaled, features.kind), most)


def probability_of(features: Features) -> float:
    """Return the probability of this effect: its presence times its weight among its look-alikes."""
    return presence_of(features) * features.weight


@cache
def _calibration() -> Calibration:
    """Return the coefficients that were fitted to simulated cases."""
    content = yaml.safe_load(CALIBRATION.read_text(encoding="utf-8"))
    return Calibration(content["intercept"], content["coefficients"], content["offsets"])
