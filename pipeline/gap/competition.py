"""How effects compete: one is added at a time, and each that stays must earn it again when the others are there."""

from dataclasses import dataclass

from torch import Tensor

from simgap.artifacts import Pace
from simgap.effects import Effect
from simgap.gap.ambiguity import (
    Rivalry,
    predicts_better,
    rivalry_of,
    rivals_of,
    total_score,
)
from simgap.gap.candidate import BEYOND_NOISE, Candidate, Judge, Starts
from simgap.gap.candidates import candidates_for
from simgap.gap.drift import drifts_of
from simgap.gap.features import features_of
from simgap.gap.fit import Fit, Problem, excess_of, fit
from simgap.gap.parsimony import single_cause
from simgap.gap.probability import presence_of
from simgap.gap.refit import extend, remove, shrink
from simgap.gap.scoring import predictive_score
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect, Simulator

_REDUNDANT = 0.2
_INCREDIBLE = 0.1  # a probability below which an effect carries no other
_SERIOUS = 0.5  # of a winner's share, with which a simpler effect may be a part of what that one explains
_EXCHANGES = 3  # each costs a round for every named effect

_pace = Pace("what is missing")


@dataclass(frozen=True)
class Round:
    """A round of the competition: every candidate, and the one that won (None where none may be named)."""

    candidates: tuple[Candidate, ...]
    winner: Candidate | None


def spoken(effect: Effect) -> str:
    """Return an effect's key as words."""
    return effect.key.replace("_", " ")


def _is_preferred(effect: Effect, other: Effect) -> bool:
    return effect.name in other.yields_to or len(effect.parameters) < len(other.parameters)


def _is_part(simpler: Candidate, winner: Candidate) -> bool:
    """Whether a simpler effect alone explains at least half of what the winner explains, and where it does."""
    same = simpler.channel == winner.channel and simpler.share > _SERIOUS * winner.share
    return same and len(simpler.effect.parameters) < len(winner.effect.parameters)


class Competition:
    """Effects of a catalogue in competition for what a simulator leaves of a recording."""

    def __init__(self, simulator: Simulator, problem: Problem, settings: Gap) -> None:
        """Fit the simulator as it is; see `name` for the course of a competition."""
        self.problem, self.settings = problem, settings
        self.catalogue = candidates_for(simulator, problem.blocks.signals, settings.effects)
        self.clusters = int(problem.cluster.max()) + 1
        self.base = self.current = fit(simulator, problem)
        self.shrunk: dict[str, Fit] = {}
        self.known = {fitted.effect.key: fitted for fitted in simulator.known}
        resting = {key: dict(fitted.values) for key, fitted in self.known.items()}
        self.judge = Judge(problem, settings, self.base, len(self.catalogue), resting)
        self.starts = Starts(problem.blocks.signals)
        self.rounds: list[Round] = []
        self.dropped: dict[str, str] = {}  # why each was, by key

    def run(self, contestants: list[Effect]) -> None:
        """Add effects until none may be named any more."""
        while len(self.current.simulator.free) < self.settings.most_effects:
            tried = [effect for effect in contestants if effect.key not in self.names() | self.dropped.keys()]
            beside = f"beside {', '.join(sorted(self.names()))}" if self.names() else "alone"
            _pace.tell(f"trying {len(tried)} effects {beside}")
            candidates = [self.candidate(effect) for effect in tried]
            admitted = [candidate for candidate in candidates if not candidate.refusal]
            winner = self.first_of(self.likeliest(admitted), admitted)
            self.rounds.append(Round(tuple(candidates), winner))
            if winner is None:
                return
            self.take(winner)

    def continued(self) -> "Competition":
        """Return a competition that goes on from what this one has named."""
        other = Competition(self.base.simulator, self.problem, self.settings)
        other.become(self.current)
        other.rounds = list(self.rounds)
        return other

    def begin_with(self, effects: list[Effect]) -> None:
        """Put effects in together, from what is known of each, and drop those that are needless beside the others."""
        missing = [effect for effect in effects if effect.key not in self.names()]
        together = tuple(FittedEffect(effect, self.judge.rest(effect)) for effect in missing)
        taken = {effect.key for effect in missing}
        others = tuple(f for f in self.current.simulator.effects if f.effect.key not in taken)
        self.become(fit(self.current.simulator.with_effects((*others, *together)), self.problem))
        self.rounds.append(Round(tuple(self.named()), None))
        self.prune()

    def finish(self) -> None:
        """Let everything compete, then what is simpler, then what fits better in another's place."""
        self.run(self.catalogue)
        self.condense()
        self.exchange()

    def conclude(self) -> None:
        """Drop what is hardly there and what cannot stay without it, and let enter what both kept out."""
        had_room = self.has_room()
        self.disown()
        self.prune()
        if not had_room and self.has_room():
            self.run(self.catalogue)
            self.conclude()

    def leaves_more_than_noise(self, fitted: Fit | None = None, times: float = BEYOND_NOISE) -> bool:
        """Whether some channel of a fit, or of the current one, holds more than the sensors' noise can account for."""
        return float(excess_of(fitted or self.current, self.problem.noise).max()) > times

    def short_times(self) -> tuple[FittedEffect, ...]:
        """Return the named effects that make something late by less than samples can tell."""
        simulator = self.current.simulator
        constants = simulator.constants()
        return tuple(f for f in simulator.free if self.judge.is_short(f.effect, f.values, constants))

    def has_room(self) -> bool:
        """Whether more effects might have been named."""
        return len(self.names()) < self.settings.most_effects

    def scores(self, fitted: Fit | None = None) -> Tensor:
        """Return the cross-validated log likelihood of each cluster of correlated residuals, (clusters,).

        Args:
            fitted: what predicts; None: the current fit.
        """
        score = predictive_score(self.judge.left_out(fitted or self.current), self.problem.noise)
        return score.new_zeros(self.clusters).index_add(0, self.problem.cluster, score)

    def take(self, winner: Candidate) -> None:
        """Fit the simulator with a winner again, and drop what it makes needless."""
        self.become(fit(winner.fit.simulator, self.problem))
        self.starts.forget()
        self.prune()

    def likeliest(self, admitted: list[Candidate]) -> Candidate | None:
        """Return the one that gains most, or a simpler or likelier cause where nothing tells the two apart."""
        best = max(admitted, key=total_score, default=None)
        if best is None:
            return None
        return max(self.tied(best, admitted), key=total_score, default=best)

    def tied(self, best: Candidate, others: list[Candidate]) -> list[Candidate]:
        """Return the simpler or likelier causes that nothing tells from the best."""
        usual = [c for c in others if _is_preferred(c.effect, best.effect)]
        return [c for c in usual if not predicts_better(best, c, self.problem.cluster)]

    def first_of(self, winner: Candidate | None, admitted: list[Candidate]) -> Candidate | None:
        """Return the winner, or a simpler effect beside which it predicts better than in that one's place.

        An effect with several valleys that had to explain another one, too, may lie in a valley that no step leads out
        of: Stribeck friction wide enough for Coulomb's. Whether both stay is decided when both are in.
        """
        if winner is None or len(winner.effect.starts()) == 1 or not self.leaves_more_than_noise(winner.fit):
            return winner
        for simpler in sorted(admitted, key=total_score, reverse=True):
            if _is_part(simpler, winner):
                both = extend(simpler.fit, winner.effect, self.problem)
                beside = self.judge(winner.effect, simpler.fit, both)
                if not beside.refusal and total_score(beside) > total_score(winner):
                    return simpler
        return winner

    def become(self, current: Fit) -> None:
        """Go on with another fit; what it would be without each effect is worked out once."""
        self.current = current
        self.shrunk.clear()

    def candidate(self, effect: Effect, without: Fit | None = None) -> Candidate:
        """Refit with the effect added and compare with the simulator without it."""
        without = without or self.current
        fitted = extend(without, effect, self.problem, self.starts.of(effect))
        self.starts.note(fitted)
        return self.judge(effect, without, fitted)

    def prune(self) -> None:
        """Drop every effect that the others have made needless, the least needed first; it does not come back."""
        while refused := [candidate for candidate in self.named() if candidate.refusal]:
            needless = min(refused, key=lambda candidate: candidate.gain)
            if not self.simplify(needless.effect):
                self.drop(needless.effect, needless.refusal)

    def simplify(self, effect: Effect) -> bool:
        """Put in a named effect's place the one that it comes down to, if that may be named; return whether it did."""
        simpler = self.limit_of(effect)
        if simpler is None:
            return False
        removed = remove(self.current, effect, self.problem, self.known.get(effect.key))
        fitted = fit(extend(removed, simpler, self.problem).simulator, self.problem)
        if self.judge(simpler, self.without(effect), fitted).refusal:
            return False
        self.dropped[effect.key] = f"comes down to {spoken(simpler)} here"
        self.dropped.pop(simpler.key, None)
        self.become(fitted)
        return True

    def limit_of(self, effect: Effect) -> Effect | None:
        """Return the effect that a named one comes down to in what was recorded, where that is not named as well."""
        blocks, simulator = self.problem.blocks, self.current.simulator
        values = next(f.values for f in simulator.free if f.effect.key == effect.key)
        limit = effect.limit(values, blocks.signals | blocks.resolution, simulator.constants())
        alike = [e for e in self.catalogue if e.name == limit and e.acts_on == effect.acts_on]
        return next((e for e in alike if e.key not in self.names()), None)

    def disown(self) -> None:
        """Drop what is hardly there, the least likely first: too little evidence, or much left beside it.

        Where that would discredit what is believed, since the residual that one explained is then left beside the
        other, both stay: the one is believed, and the other said with the little probability that it has. What is
        incredible by itself carries nothing.
        """
        companions: set[str] = set()
        while True:
            believed, doubted = self.beliefs()
            doubtful = {key: presence for key, presence in doubted.items() if key not in companions}
            if not doubtful:
                return
            before, worst = self.current, min(doubtful, key=lambda key: doubtful[key])
            effect = next(f.effect for f in before.simulator.free if f.effect.key == worst)
            self.drop(effect, f"probability of only {doubtful[worst]:.0%}")
            carries = doubtful[worst] > _INCREDIBLE and not believed.keys() <= self.beliefs()[0].keys()
            if carries:
                self.become(before)
                self.dropped.pop(worst, None)
                companions.add(worst)

    def beliefs(self) -> tuple[dict[str, float], dict[str, float]]:
        """Return the presence of the named effects, of those that may be named and of the others, by key."""
        presence = {candidate.effect.key: self.presence(candidate) for candidate in self.named()}
        least = self.settings.least_probability
        believed = {key: value for key, value in presence.items() if value >= least}
        return believed, {key: value for key, value in presence.items() if value < least}

    def named(self) -> list[Candidate]:
        """Return every named effect, each judged as if it had entered last."""
        return [self.alone(fitted.effect) for fitted in self.current.simulator.free]

    def drop(self, effect: Effect, why: str) -> None:
        """Leave an effect out for good, and fit the others again."""
        without = self.without(effect).simulator
        self.dropped[effect.key] = why
        self.become(fit(without, self.problem))

    def condense(self) -> None:
        """Put one effect in the place of two parameter errors where it explains as much."""
        simpler = single_cause(self.current, self.catalogue, self.problem, self.known)
        if simpler is None:
            return
        effect, fitted, without = simpler
        winner = self.judge(effect, without, fitted)
        kept = {effect.key} | {fitted.effect.key for fitted in without.simulator.free}
        others = tuple(self.candidate(e, without) for e in self.catalogue if e.key not in kept)
        self.rounds.append(Round((winner, *others), winner))
        self.take(winner)
        self.run(self.catalogue)

    def exchange(self) -> None:
        """Put another effect in the place of a named one wherever it predicts better there, or as well and is simpler.

        The order in which effects entered, and the platform's numbers coming first, must not decide.
        """
        seen = [self.names()]
        for _ in range(_EXCHANGES):
            better = [
                swap for fitted in self.current.simulator.free if (swap := self.better_than(fitted.effect))
            ]
            if not better:
                return
            _, candidates, winner = max(better, key=lambda swap: swap[0])
            self.rounds.append(Round(candidates, winner))
            self.dropped.pop(winner.effect.key, None)
            self.take(winner)
            self.run(self.catalogue)
            if self.names() in seen:
                return
            seen.append(self.names())

    def names(self) -> set[str]:
        """Return the keys of the effects that are in."""
        return {fitted.effect.key for fitted in self.current.simulator.free}

    def better_than(self, effect: Effect) -> tuple[float, tuple[Candidate, ...], Candidate] | None:
        """Return by how much another effect would predict better in the place of a named one, the round, and it.

        None where no other predicts better beyond chance, nor a simpler or likelier cause as well.
        """
        without, own = self.without(effect), self.alone(effect)
        candidates = tuple(self.candidate(e, without) for e in self.catalogue if e.key not in self.names())
        admitted = [candidate for candidate in candidates if not candidate.refusal]
        better = [c for c in admitted if predicts_better(c, own, self.problem.cluster)]
        winner = self.likeliest(better or self.tied(own, admitted))
        return (total_score(winner) - total_score(own), candidates, winner) if winner else None

    def presence(self, candidate: Candidate) -> float:
        """Return the probability that an effect of this kind is there, whichever of its rivals it is."""
        drifts = drifts_of(self.current, candidate.effect, self.problem.blocks, self.problem.cluster)
        return presence_of(features_of(candidate, self.current, self.problem, drifts))

    def without(self, effect: Effect) -> Fit:
        """Return the current fit without an effect, or with what was known of it before."""
        if effect.key not in self.shrunk:
            self.shrunk[effect.key] = shrink(self.current, effect, self.problem, self.known.get(effect.key))
        return self.shrunk[effect.key]

    def alone(self, effect: Effect) -> Candidate:
        """Judge an effect of the current simulator as if it had been the last to enter."""
        return self.judge(effect, self.without(effect), self.current)

    def rivalry(self, winner: Candidate) -> Rivalry | None:
        """Return the effects that could stand in for a named one."""
        without = self.without(winner.effect)
        close = [e for e in self.close_to(winner.effect) if e.key not in self.names()]
        others = [self.candidate(effect, without) for effect in close]
        rivals = rivals_of(winner, [c for c in others if not c.refusal], self.problem.cluster)
        return rivalry_of(
            winner, [rival for rival in rivals if self.is_needless(rival)], self.problem.cluster
        )

    def close_to(self, winner: Effect) -> list[Effect]:
        """Return the effects that came close to a winner in the round it won: only they can stand in for it.

        Those that had no part in that round, since only numbers and clocks were settled in it, may stand in, too.
        """
        for turn in reversed(self.rounds):
            if turn.winner is not None and turn.winner.effect.key == winner.key:
                least = 0.5 * turn.winner.share
                far = {c.effect.key for c in turn.candidates if c.share <= least}
                return [effect for effect in self.catalogue if effect.key not in far]
        return self.catalogue

    def is_needless(self, rival: Candidate) -> bool:
        """Whether the winner leaves nothing for a rival to explain: then both explain the same residual."""
        return self.candidate(rival.effect).gain < _REDUNDANT * rival.gain
