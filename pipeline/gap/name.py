"""Which physics is missing: effects compete to explain the residual on runs they were not fitted on."""

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

_OUTDONE = 0.1  # of the weight among rivals, with which a name is none any more
_TIMES_NOISE = 10.0  # times the energy of the noise


@dataclass(frozen=True)
class Naming:
    """What was named.

    Attributes:
        base: fit of the nominal simulator.
        fit: fit of the simulator with every named effect.
        named: the effects in the final simulator, each as if it had been the last to enter.
        rounds: the competition.
        rivalries: effects that this recording cannot tell apart.
        short: the named effects that make something late by less than samples can tell.
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
    """Let the catalogue compete for the residual of a nominal simulator.

    Clock offsets and the platform's own numbers are settled first: what they explain is no missing physics. Then one
    effect is added at a time; each that stays must earn it again when the others are there. Where something was settled
    and more than noise is left, it may have stood in for physics that explains more: then the competition is held again
    with everything in it from the start, and counts where it predicts better. Where very much is still left, numbers
    and the physics that any such machine has may show only together: a competition that begins with them is held, and
    one that puts them beside what was named, without which they may not show either.
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
    much_is_left = competition.leaves_more_than_noise(times=_TIMES_NOISE)
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
    """Return another competition, begun with what any machine has, where very much is left and it predicts better."""
    usual = usual_of(competition.catalogue)
    if not (usual and competition.leaves_more_than_noise(times=_TIMES_NOISE)):
        return competition
    other.begin_with(usual)
    other.finish()
    return other if is_beyond_chance(other.scores() - competition.scores()) else competition


def _rivalries(competition: Competition) -> tuple[Rivalry, ...]:
    """Return what could stand in for each named effect, of those for which something could."""
    return tuple(
        rivalry for winner in competition.named() if (rivalry := competition.rivalry(winner)) is not None
    )


def usual_of(catalogue: list[Effect]) -> list[Effect]:
    """Return the physics that any machine of the kind has with the numbers of the platform, where there is such."""
    physics = [effect for effect in catalogue if effect.usual]
    numbers = [effect for effect in catalogue if isinstance(effect, ParameterError)]
    return numbers + physics if physics else []


def _numbers_and_clocks(catalogue: list[Effect]) -> list[Effect]:
    """Return what is settled before physics is asked, and what that may be mistaken for."""
    errors = [e for e in catalogue if isinstance(e, MeasurementEffect | ParameterError)]
    mistaken = {name for effect in errors for name in effect.yields_to}
    return errors + [e for e in catalogue if e.name in mistaken]
