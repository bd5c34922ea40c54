"""Forward selection with backward elimination of the effects of the catalogue."""

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

_REDUNDANT = 0.2  # of its gain, below which a rival explains nothing beside the winner
_INCREDIBLE = 0.1  # probability below which an effect is dropped even if others depend on it
_SERIOUS = 0.5  # of the winner's share, above which a simpler effect may be a part of it
_EXCHANGES = 3  # each costs a round for every named effect

_pace = Pace("selecting effects")


@dataclass(frozen=True)
class Round:
    """A round of the selection: all candidates, and the winner (None if all are refused)."""

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
    """The selection of effects that explain the residual of a simulator."""

    def __init__(self, simulator: Simulator, problem: Problem, settings: Gap) -> None:
        """Fit the simulator as it is; see `simgap.gap.name` for the order of the moves."""
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
        """Add effects until all candidates are refused."""
        while len(self.current.simulator.free) < self.settings.most_effects:
            tried = [effect for effect in contestants if effect.key not in self.names() | self.dropped.keys()]
            named = ", ".join(sorted(self.names())) or "none"
            _pace.tell(f"trying {len(tried)} effects (named so far: {named})")
            candidates = [self.candidate(effect) for effect in tried]
            admitted = [candidate for candidate in candidates if not candidate.refusal]
            winner = self.first_of(self.likeliest(admitted), admitted)
            self.rounds.append(Round(tuple(candidates), winner))
            if winner is None:
                return
            self.take(winner)

    def continued(self) -> "Competition":
        """Return a selection that continues from the effects named here."""
        other = Competition(self.base.simulator, self.problem, self.settings)
        other.become(self.current)
        other.rounds = list(self.rounds)
        return other

    def begin_with(self, effects: list[Effect]) -> None:
        """Add several effects at once, then eliminate those that are not needed."""
        missing = [effect for effect in effects if effect.key not in self.names()]
        together = tuple(FittedEffect(effect, self.judge.rest(effect)) for effect in missing)
        taken = {effect.key for effect in missing}
        others = tuple(f for f in self.current.simulator.effects if f.effect.key not in taken)
        self.become(fit(self.current.simulator.with_effects((*others, *together)), self.problem))
        self.rounds.append(Round(tuple(self.named()), None))
        self.prune()

    def finish(self) -> None:
        """Select from the whole catalogue, then condense, then exchange."""
        self.run(self.catalogue)
        self.condense()
        self.exchange()

    def conclude(self) -> None:
        """Drop effects with a low probability and those that are not needed without them; refill free places."""
        had_room = self.has_room()
        self.disown()
        self.prune()
        if not had_room and self.has_room():
            self.run(self.catalogue)
            self.conclude()

    def leaves_more_than_noise(self, fitted: Fit | None = None, times: float = BEYOND_NOISE) -> bool:
        """Whether some channel of a fit (default: the current one) leaves more than `times` the noise energy."""
        return float(excess_of(fitted or self.current, self.problem.noise).max()) > times

    def short_times(self) -> tuple[FittedEffect, ...]:
        """Return the named effects whose delay is shorter than the sampling can show."""
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
        """Refit the simulator with a winner, then eliminate effects that it makes unnecessary."""
        self.become(fit(winner.fit.simulator, self.problem))
        self.starts.forget()
        self.prune()

    def likeliest(self, admitted: list[Candidate]) -> Candidate | None:
        """Return the best candidate, or a simpler or likelier one that is not significantly worse."""
        best = max(admitted, key=total_score, default=None)
        if best is None:
            return None
        return max(self.tied(best, admitted), key=total_score, default=best)

    def tied(self, best: Candidate, others: list[Candidate]) -> list[Candidate]:
        """Return the simpler or likelier candidates that are not significantly worse than the best."""
        usual = [c for c in others if _is_preferred(c.effect, best.effect)]
        return [c for c in usual if not predicts_better(best, c, self.problem.cluster)]

    def first_of(self, winner: Candidate | None, admitted: list[Candidate]) -> Candidate | None:
        """Return the winner, or a simpler effect if both together predict better than the winner alone.

        An effect with several local minima may have ended in a wrong one, because it had to explain another effect too:
        Stribeck friction so wide that it is Coulomb friction as well. Backward elimination decides later on both.
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
        """Continue with another fit; fits without each effect are cached."""
        self.current = current
        self.shrunk.clear()

    def candidate(self, effect: Effect, without: Fit | None = None) -> Candidate:
        """Refit with the effect added and compare with the simulator without it."""
        without = without or self.current
        fitted = extend(without, effect, self.problem, self.starts.of(effect))
        self.starts.note(fitted)
        return self.judge(effect, without, fitted)

    def prune(self) -> None:
        """Backward elimination: drop each refused effect, the one with the least gain first, for good."""
        while refused := [candidate for candidate in self.named() if candidate.refusal]:
            needless = min(refused, key=lambda candidate: candidate.gain)
            if not self.simplify(needless.effect):
                self.drop(needless.effect, needless.refusal)

    def simplify(self, effect: Effect) -> bool:
        """Replace a named effect by the law that it equals in this recording, if possible; return whether it did."""
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
        """Return the law that a named effect equals in this recording, unless that is named as well."""
        blocks, simulator = self.problem.blocks, self.current.simulator
        values = next(f.values for f in simulator.free if f.effect.key == effect.key)
        limit = effect.limit(values, blocks.signals | blocks.resolution, simulator.constants())
        alike = [e for e in self.catalogue if e.name == limit and e.acts_on == effect.acts_on]
        return next((e for e in alike if e.key not in self.names()), None)

    def disown(self) -> None:
        """Drop effects whose probability is below the threshold, the least likely first.

        An effect stays if dropping it would push a believed effect below the threshold: what it explained would then
        be left beside that one. It keeps its low probability. Below `_INCREDIBLE` it is dropped in any case.
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
        """Return the presence of the named effects by key: at or above the threshold, and below."""
        presence = {candidate.effect.key: self.presence(candidate) for candidate in self.named()}
        least = self.settings.least_probability
        believed = {key: value for key, value in presence.items() if value >= least}
        return believed, {key: value for key, value in presence.items() if value < least}

    def named(self) -> list[Candidate]:
        """Return every named effect, scored as if it had entered last."""
        return [self.alone(fitted.effect) for fitted in self.current.simulator.free]

    def drop(self, effect: Effect, why: str) -> None:
        """Remove an effect for good and refit the others."""
        without = self.without(effect).simulator
        self.dropped[effect.key] = why
        self.become(fit(without, self.problem))

    def condense(self) -> None:
        """Replace two parameter errors by one effect where it explains as much."""
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
        """Replace a named effect by another one that predicts better in its place, or as well and is simpler.

        This corrects the order of entry, in which the numbers of the platform come first.
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
        """Return (gain, candidates, winner) of the best replacement of a named effect.

        None if no other effect predicts significantly better, and no simpler or likelier one as well.
        """
        without, own = self.without(effect), self.alone(effect)
        candidates = tuple(self.candidate(e, without) for e in self.catalogue if e.key not in self.names())
        admitted = [candidate for candidate in candidates if not candidate.refusal]
        better = [c for c in admitted if predicts_better(c, own, self.problem.cluster)]
        winner = self.likeliest(better or self.tied(own, admitted))
        return (total_score(winner) - total_score(own), candidates, winner) if winner else None

    def presence(self, candidate: Candidate) -> float:
        """Return the probability that the effect or one of its rivals is present."""
        drifts = drifts_of(self.current, candidate.effect, self.problem.blocks, self.problem.cluster)
        return presence_of(features_of(candidate, self.current, self.problem, drifts))

    def without(self, effect: Effect) -> Fit:
        """Return the current fit without an effect, or with its values known before."""
        if effect.key not in self.shrunk:
            self.shrunk[effect.key] = shrink(self.current, effect, self.problem, self.known.get(effect.key))
        return self.shrunk[effect.key]

    def alone(self, effect: Effect) -> Candidate:
        """Score an effect of the current simulator as if it had entered last."""
        return self.judge(effect, self.without(effect), self.current)

    def rivalry(self, winner: Candidate) -> Rivalry | None:
        """Return a named effect with its look-alikes; None if there are none."""
        without = self.without(winner.effect)
        close = [e for e in self.close_to(winner.effect) if e.key not in self.names()]
        others = [self.candidate(effect, without) for effect in close]
        rivals = rivals_of(winner, [c for c in others if not c.refusal], self.problem.cluster)
        return rivalry_of(
            winner, [rival for rival in rivals if self.is_needless(rival)], self.problem.cluster
        )

    def close_to(self, winner: Effect) -> list[Effect]:
        """Return the possible look-alikes of a winner: effects with at least half of its share in the round it won.

        Effects that took no part in that round are included.
        """
        for turn in reversed(self.rounds):
            if turn.winner is not None and turn.winner.effect.key == winner.key:
                least = 0.5 * turn.winner.share
                far = {c.effect.key for c in turn.candidates if c.share <= least}
                return [effect for effect in self.catalogue if effect.key not in far]
        return self.catalogue

    def is_needless(self, rival: Candidate) -> bool:
        """Whether a rival gains little beside the winner, so that both explain the same residual."""
        return self.candidate(rival.effect).gain < _REDUNDANT * rival.gain
