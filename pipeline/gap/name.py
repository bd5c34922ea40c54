"""Selection of the missing effects: the order of the selection's moves."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from simgap.effects import Effect, MeasurementEffect, ParameterError
from simgap.gap.ambiguity import Rivalry, is_beyond_chance
from simgap.gap.candidate import Candidate
from simgap.gap.competition import Competition, Round
from simgap.gap.fit import Fit, Problem
from simgap.gap.look_alikes import substitute, unite
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect, Simulator

_OUTDONE = 0.1  # weight among rivals, below which one more exchange is tried
_TIMES_NOISE_ENERGY = 10.0  # times the energy of the noise


@dataclass(frozen=True)
class Naming:
    """The result of the selection.

    Attributes:
        base: fit of the nominal simulator.
        fit: fit of the simulator with every named effect.
        named: the named effects, each scored as if it had entered last.
        rounds: all rounds of the selection.
        rivalries: named effects with look-alikes.
        short: named effects whose delay is shorter than the sampling can show.
        dropped: why an effect that was added is out again, by key.
    """

    base: Fit
    fit: Fit
    named: tuple[Candidate, ...]
    rounds: tuple[Round, ...]
    rivalries: tuple[Rivalry, ...]
    short: tuple[FittedEffect, ...] = ()
    dropped: Mapping[str, str] = field(default_factory=dict)


def name(simulator: Simulator, problem: Problem, settings: Gap) -> Naming:
    """Select the effects that explain the residual of a nominal simulator.

    Clock offsets and errors of platform numbers come first, since they are not missing physics. Then one effect is
    added at a time, with backward elimination. If a number was named and more than noise is left, the selection is
    repeated with the whole catalogue from the start; it counts if it predicts significantly better. If ten times the
    noise is still left, a selection begins with all numbers and the usual friction together, and another one adds them
    to the named effects, because they may show only together.
    """
    competition = Competition(simulator, problem, settings)
    settled = _numbers_and_clocks(competition.catalogue)
    competition.run(settled)
    competition.finish()
    rests_on_them = competition.names() & {effect.key for effect in settled}
    if competition.leaves_more_than_noise() and competition.has_room() and rests_on_them:
        again = Competition(simulator, problem, settings)
        again.finish()
        if is_beyond_chance(again.scores() - competition.scores()):
            competition = again
    competition = _begun_with_usual(competition, Competition(simulator, problem, settings))
    competition = _begun_with_usual(competition, competition.continued())
    competition.conclude()
    rivalries = _rivalries(competition)
    if any(rivalry.weight < _OUTDONE for rivalry in rivalries):
        competition.exchange()
        competition.conclude()
        rivalries = _rivalries(competition)
    much_is_left = competition.leaves_more_than_noise(times=_TIMES_NOISE_ENERGY)
    if (much_is_left and substitute(competition, rivalries)) or unite(competition, rivalries):
        competition.conclude()
        rivalries = _rivalries(competition)
    return Naming(
        competition.base,
        competition.current,
        tuple(competition.named()),
        tuple(competition.rounds),
        rivalries,
        competition.short_times(),
        competition.dropped,
    )


def _begun_with_usual(competition: Competition, other: Competition) -> Competition:
    """Return another selection, begun with the usual effects, if much is left and it predicts better."""
    usual = usual_of(competition.catalogue)
    if not (usual and competition.leaves_more_than_noise(times=_TIMES_NOISE_ENERGY)):
        return competition
    other.begin_with(usual)
    other.finish()
    return other if is_beyond_chance(other.scores() - competition.scores()) else competition


def _rivalries(competition: Competition) -> tuple[Rivalry, ...]:
    """Return the named effects that have look-alikes, with these."""
    return tuple(
        rivalry for winner in competition.named() if (rivalry := competition.rivalry(winner)) is not None
    )


def usual_of(catalogue: list[Effect]) -> list[Effect]:
    """Return the errors of platform numbers and the usual effects of the kind; empty if it has none."""
    physics = [effect for effect in catalogue if effect.usual]
    numbers = [effect for effect in catalogue if isinstance(effect, ParameterError)]
    return numbers + physics if physics else []


def _numbers_and_clocks(catalogue: list[Effect]) -> list[Effect]:
    """Return the effects that compete first: clocks, numbers, and what these may be mistaken for."""
    errors = [e for e in catalogue if isinstance(e, MeasurementEffect | ParameterError)]
    mistaken = {name for effect in errors for name in effect.yields_to}
    return errors + [e for e in catalogue if e.name in mistaken]
