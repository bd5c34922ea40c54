"""A hypothesis about what a simulator lacks, and the evidence for it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.effects import ParameterError
from simgap.equations.fit import Fit, bounds_of
from simgap.equations.resolution import is_short
from simgap.gap.likelihood import Likelihood
from simgap.gap.prior import log_odds, log_prior, prior_precision
from simgap.gap.reading import Reading, Timing
from simgap.simulation import FittedEffect, Simulator

_TOLERANCE = 0.015
"""Relative error of a platform number that is none: noise in the inputs of a fit biases by as much."""
_LEAST_VARIANCE = 1e-9
"""Of a parameter on the scale of its own information: rounding makes it no smaller."""
_NO_SIZE = 1e-9
"""Of its realistic size: an effect that is no larger does nothing, and is no other hypothesis than the one without."""


@dataclass(frozen=True)
class Hypothesis:
    """A set of effects with its fit and its evidence.

    Attributes:
        reading: how the commands act.
        keys: of the effects that the nominal simulator lacks.
        fit: of the simulator with them.
        likelihood: of the recording.
        occam: log of the share of the prior's volume that the recording leaves to the parameters (Laplace).
        prior: log prior odds of the effects.
    """

    reading: Reading
    keys: frozenset[str]
    fit: Fit
    likelihood: Likelihood
    occam: float
    prior: float

    @property
    def place(self) -> tuple[Timing, frozenset[str]]:
        """What tells it from other hypotheses."""
        return self.reading.timing, self.keys

    @property
    def names(self) -> frozenset[str]:
        """The effects worth a name: all but trends, and those within what timing and platform numbers are known to."""
        simulator, reading = self.fit.simulator, self.reading
        steady = (f for f in simulator.free if not f.effect.trends)
        return frozenset(f.effect.key for f in steady if not is_tolerance(f, simulator, reading))

    @property
    def doubtful(self) -> frozenset[str]:
        """The effects that might not be there: all but numbers that are identified beside every hypothesis."""
        return frozenset(f.effect.key for f in self.fit.simulator.free if f.effect.names_physics)

    @property
    def score(self) -> float:
        """The log evidence times the prior, up to a constant that all hypotheses share."""
        return self.likelihood.value + self.occam + self.prior


def weigh(fitted: Fit, reading: Reading) -> Hypothesis:
    """Return the hypothesis that a fit stands for, with the Laplace approximation of its evidence.

    Source: MacKay 1992, Bayesian interpolation (Neural Computation 4), eq. 2.5.
    """
    likelihood, scales = reading.likelihood_of(fitted), reading.scales
    keys = frozenset(f.effect.key for f in fitted.simulator.free)
    occam = log_prior(fitted, scales) + _log_volume(fitted, likelihood, prior_precision(fitted, scales))
    return Hypothesis(reading, keys, fitted, likelihood, occam, _log_prior_odds(fitted, reading))


def information_of(fitted: Fit, likelihood: Likelihood) -> Tensor:
    """Return the tempered Fisher information of a fit's parameters, (parameters, parameters)."""
    jacobian = fitted.jacobian
    return torch.einsum("brcp,brcq,bc->pq", jacobian, jacobian, likelihood.weight)


def _log_volume(fitted: Fit, likelihood: Likelihood, precision: Tensor) -> float:
    """Return the log of the posterior's volume over its peak, ∫exp(−½ΔᵀAΔ), in whatever units the parameters are.

    Of a parameter near a bound only the part of its Gaussian inside the bounds counts.
    """
    if not len(precision):
        return 0.0
    information = information_of(fitted, likelihood) + torch.diag(precision)
    size = information.diagonal().sqrt()
    scaled = information / size / size[:, None]
    _, determinant = torch.linalg.slogdet(scaled)
    deviation = torch.linalg.pinv(scaled, hermitian=True).diagonal().clamp_min(_LEAST_VARIANCE).sqrt() / size
    low, high = bounds_of(fitted.simulator)
    inside = torch.special.ndtr((high - fitted.values) / deviation) - torch.special.ndtr(
        (low - fitted.values) / deviation
    )
    whole = 0.5 * len(precision) * math.log(2.0 * math.pi) - 0.5 * determinant - size.log().sum()
    return float(whole + inside.clamp_min(_LEAST_VARIANCE).log().sum())


def is_tolerance(fitted: FittedEffect, simulator: Simulator, reading: Reading) -> bool:
    """Whether an effect is within what is known: a delay of a part of a sample, a number off by a percent.

    It stays in the simulator, where it keeps others from standing in for it, and gets no name. Nor does a number that
    nobody gave and that is identified beside the effects.
    """
    if not fitted.effect.names_physics:
        return True
    if isinstance(fitted.effect, ParameterError):
        return all(abs(float(ratio) - 1.0) < _TOLERANCE for ratio in fitted.values.values())
    constants = simulator.constants()
    if fitted.effect.stands_for(fitted.values, constants) < _TOLERANCE:
        return True
    return _is_short(fitted, simulator, reading)


def _is_short(fitted: FittedEffect, simulator: Simulator, reading: Reading) -> bool:
    """Whether an effect delays too little to be told from the timing, together with all others that do."""

    def late(each: FittedEffect) -> float:
        return each.effect.lateness(each.values, simulator.constants())

    def short(seconds: float) -> bool:
        return is_short(seconds, reading.problem.blocks.time_step, reading.held)

    group = fitted.effect.key.partition("@")[2]
    beside = (f for f in simulator.free if f.effect.key.partition("@")[2] == group)
    return short(late(fitted)) and short(sum(filter(short, map(late, beside))))


def _log_prior_odds(fitted: Fit, reading: Reading) -> float:
    named = (f for f in fitted.simulator.free if not is_tolerance(f, fitted.simulator, reading))
    constants = fitted.simulator.constants()
    return math.log(reading.odds) + sum(log_odds(f.effect, constants) for f in named)


def idle_in(fitted: Fit, reading: Reading) -> list[FittedEffect]:
    """Return the effects of a fit that do nothing: what stands there is the hypothesis without them."""
    known = {f.effect.key: f.values for f in reading.nominal.known}
    named = (f for f in fitted.simulator.free if f.effect.names_physics)
    return [f for f in named if _is_idle(f, known.get(f.effect.key))]


def _is_idle(fitted: FittedEffect, known: Mapping[str, float] | None) -> bool:
    """Whether an effect does nothing new: its first parameter, its size, is where it changes nothing, or as known."""
    first = fitted.effect.parameters[0]
    rest = known[first.name] if known else first.neutral
    return abs(float(fitted.values[first.name]) - rest) <= _NO_SIZE * abs(first.default)
