"""What is named: the effects that the posterior over hypotheses believes in."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import torch

from simgap.effects import Effect
from simgap.equations.fit import Fit
from simgap.equations.refit import remove
from simgap.gap.calibration import calibrated
from simgap.gap.hypothesis import Hypothesis
from simgap.gap.posterior import Posterior, posterior_of
from simgap.gap.reading import Reading
from simgap.gap.search import Search
from simgap.gap.settings import BELIEVED, POSSIBLE, Gap
from simgap.simulation import FittedEffect

_LEAST_EXCESS = 0.01
"""Of the noise energy: what a share is related to where nothing was left."""
_DIGITS = 2
"""Of a probability that is stated: a few hundred cases that it is calibrated on tell no more."""


@dataclass(frozen=True)
class Named:
    """One named effect.

    Attributes:
        fitted: the effect with its values.
        probability: of its being there, recalibrated and rounded.
        channel: index of the channel of whose residual it explains most.
        share: of the error above the noise there that it explains beside the others.
    """

    fitted: FittedEffect
    probability: float
    channel: int
    share: float

    @property
    def effect(self) -> Effect:
        """The effect."""
        return self.fitted.effect


@dataclass(frozen=True)
class Rivalry:
    """A named effect and those that the recording cannot tell from it.

    Attributes:
        winner: the named effect.
        rivals: effects of which one is there in its place.
    """

    winner: Effect
    rivals: tuple[Effect, ...]


@dataclass(frozen=True)
class Naming:
    """The result of the search.

    Attributes:
        posterior: over all hypotheses that were visited.
        best: the most probable one, with what grows or fades in it at its mean.
        base: fit of the nominal simulator to the rows of the best hypothesis.
        fit: of the best hypothesis.
        shares: of the error that each possible effect explains beside the others, where it explains most, by key.
        named: the named effects, the most probable first.
        rivalries: named effects with rivals.
        complete: whether the search came to its end within its budget.
        sound: probability that the columns are what they are taken for; all names hold only then.
    """

    posterior: Posterior
    best: Hypothesis
    base: Fit
    fit: Fit
    shares: Mapping[str, float]
    named: tuple[Named, ...]
    rivalries: tuple[Rivalry, ...]
    complete: bool
    sound: float = 1.0

    @property
    def trend(self) -> FittedEffect | None:
        """What grows or fades in the most probable hypothesis, if anything does."""
        return next((f for f in self.posterior.best.fit.simulator.free if f.effect.trends), None)

    @property
    def probabilities(self) -> dict[str, float]:
        """The probability of each effect that was considered, by key, as it is stated, the most probable first."""
        inclusion = self.posterior.inclusion().items()
        stated = {key: _stated(raw, self.shares.get(key, 0.0)) for key, raw in inclusion}
        stated = {key: self._if_sound(probability) for key, probability in stated.items()}
        return dict(sorted(stated.items(), key=lambda entry: -entry[1]))

    def doubted(self, doubt: float) -> "Naming":
        """Return the same names with the probability that a column is another one than it is taken for."""
        less = replace(self, sound=self.sound * (1.0 - doubt))
        named = [replace(each, probability=less._if_sound(each.probability)) for each in self.named]
        return replace(less, named=in_order(named))

    def _if_sound(self, probability: float) -> float:
        return round(self.sound * probability, _DIGITS)


def name(readings: Sequence[Reading], settings: Gap) -> Naming:
    """Search for the effects that a nominal simulator lacks.

    Args:
        readings: the recording under every timing of its commands.
        settings: of the gap engine.
    """
    search = Search(readings, settings)
    complete = search.run(settings.most_effects, settings.budget)
    posterior = posterior_of(list(search.visited.values()))
    best = posterior.best
    base = search.bases[best.reading.timing]
    settled = search.at_mean(best)
    possible = _possible(posterior, base, min(POSSIBLE, settings.least_probability))
    named = _named(posterior, possible, settings.least_probability)
    shares = {key: each.share for key, each in possible.items()}
    return Naming(
        posterior, settled, base, settled.fit, shares, named, _rivalries(posterior, named), complete
    )


def _possible(posterior: Posterior, base: Fit, least: float) -> dict[str, Named]:
    """Return what would be said of each effect that is probable enough to be worth it, by key."""
    found = {}
    for key, raw in posterior.inclusion().items():
        if raw >= least:
            hypothesis = posterior.best_with(key)
            fitted = next(f for f in hypothesis.fit.simulator.free if f.effect.key == key)
            channel, share = _share(hypothesis, fitted.effect, base)
            found[key] = Named(fitted, _stated(raw, share), channel, share)
    return found


def _named(posterior: Posterior, possible: Mapping[str, Named], least: float) -> tuple[Named, ...]:
    """Return the names of the best hypothesis that are probable enough, and others that are more likely than not.

    The posterior decides what is named, and recalibration what is said of it: two effects that stand in for each other
    share what is certain of both together.
    """
    raw = posterior.inclusion()
    return in_order(
        [
            each
            for key, each in possible.items()
            if raw[key] >= (least if key in posterior.best.names else BELIEVED)
        ]
    )


def in_order(named: Sequence[Named]) -> tuple[Named, ...]:
    """Return names, the most probable first; of equally sure ones what fewer machines have, then what explains more.

    That a joint has some friction surprises nobody.
    """

    def place(each: Named) -> tuple[float, float, float, str]:
        return -each.probability, each.effect.prior_odds, -each.share, each.effect.key

    return tuple(sorted(named, key=place))


def _stated(raw: float, share: float) -> float:
    return round(calibrated(raw, share), _DIGITS)


def _share(hypothesis: Hypothesis, effect: Effect, base: Fit) -> tuple[int, float]:
    """Return the channel in which an effect explains most, and the share of the error there that it explains."""
    found, reading = hypothesis.fit, hypothesis.reading
    problem, noise = reading.problem, reading.problem.noise.square()
    without = remove(found, effect, problem, reading.known(effect)).residual.square().mean((0, 1))
    explained = without - found.residual.square().mean((0, 1))
    channel = int((explained / torch.maximum(without, noise)).argmax())
    gap = base.residual.square().mean((0, 1)) - noise
    excess = torch.maximum(torch.maximum(gap, without - noise), _LEAST_EXCESS * noise)
    return channel, float((explained / excess)[channel].clamp(0.0, 1.0))


def _rivalries(posterior: Posterior, named: Sequence[Named]) -> tuple[Rivalry, ...]:
    pairs = posterior.rivals()
    rivalries = []
    for winner in (entry.effect for entry in named):
        keys = {b if a == winner.key else a for a, b in pairs if winner.key in (a, b)}
        if keys:
            rivals = tuple(posterior.effect(key) for key in sorted(keys))
            rivalries.append(Rivalry(winner, rivals))
    return tuple(rivalries)
