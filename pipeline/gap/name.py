"""Which physics is missing: effects compete to explain the residual on runs they were not fitted on."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from torch import Tensor

from pipeline.effects import Effect, MeasurementEffect, ParameterError
from pipeline.gap.ambiguity import Rivalry, predicts_better, rivalry_of, rivals_of, total_score
from pipeline.gap.candidates import candidates_for
from pipeline.gap.fit import Fit, Problem, columns_of, fit
from pipeline.gap.model import drifts_of, unsteadiness_of
from pipeline.gap.parsimony import single_cause
from pipeline.gap.probability import Signs, presence_of
from pipeline.gap.refit import extend, shrink
from pipeline.gap.scoring import cross_validated, folds_of, log_score, significance_of
from pipeline.gap.settings import Gap
from pipeline.simulation import Simulator

_Z95 = 1.96
_REDUNDANT = 0.2
_BELIEVED = 0.5
_EXCHANGES = 3  # each costs a round for every named effect
_LEAST_ERROR = (
    0.002  # of a platform's number: equations of motion sampled a few times per window are no better
)
_LEAST_ENERGY = 0.01  # of the noise's: less than this nobody would see in a prediction


@dataclass(frozen=True)
class Candidate:
    """One effect's entry in a round of the competition.

    Attributes:
        effect: what was added to the simulator of that round.
        fit: the refitted simulator.
        residual: cross-validated, (blocks, rows, channels).
        gain: cross-validated log likelihood gained, corrected for correlated rows.
        share: of the excess over the noise floor, in the channel that gains most.
        share_interval: 95 % interval of the share, over clusters of correlated residuals.
        p_value: of the effect's parameters differing from doing nothing.
        design_effect: how many correlated rows count as one.
        refusal: why it may not be named; empty where it may.
    """

    effect: Effect
    fit: Fit
    residual: Tensor
    gain: float
    share: float
    share_interval: tuple[float, float]
    p_value: float
    design_effect: float
    refusal: str = ""


@dataclass(frozen=True)
class Round:
    """A round of the competition: every candidate, and the one that won (None where none may be named)."""

    candidates: tuple[Candidate, ...]
    winner: Candidate | None


@dataclass(frozen=True)
class Naming:
    """What was named.

    Attributes:
        base: fit of the nominal simulator.
        fit: fit of the simulator with every named effect.
        named: the effects in the final simulator, each as if it had been the last to enter.
        rounds: the competition.
        rivalries: effects that this recording cannot tell apart.
    """

    base: Fit
    fit: Fit
    named: tuple[Candidate, ...]
    rounds: tuple[Round, ...]
    rivalries: tuple[Rivalry, ...]


def name(simulator: Simulator, problem: Problem, settings: Gap) -> Naming:
    """Let the catalogue compete for the residual of a nominal simulator.

    Clock offsets and the platform's own numbers are settled first: what they explain is no missing physics. Then one
    effect is added at a time; each that stays must earn it again when the others are there.
    """
    competition = _Competition(simulator, problem, settings)
    competition.run(_settled(competition.catalogue))
    competition.run(competition.catalogue)
    competition.condense()
    competition.exchange()
    competition.disown()
    return competition.result()


def _settled(catalogue: list[Effect]) -> list[Effect]:
    """Return what is settled before physics is asked, and what that may be mistaken for."""
    errors = [e for e in catalogue if isinstance(e, MeasurementEffect | ParameterError)]
    mistaken = {name for effect in errors for name in effect.yields_to}
    return errors + [e for e in catalogue if e.name in mistaken]


def _is_preferred(effect: Effect, other: Effect) -> bool:
    return effect.name in other.yields_to or len(effect.parameters) < len(other.parameters)


class _Competition:
    def __init__(self, simulator: Simulator, problem: Problem, settings: Gap) -> None:
        self.problem, self.settings = problem, settings
        self.catalogue = candidates_for(simulator, problem.blocks.signals, settings.effects)
        self.fold = folds_of(problem.blocks, settings.folds)
        self.clusters = int(problem.cluster.max()) + 1
        self.base = self.current = fit(simulator, problem)
        self.known = {fitted.effect.key: fitted for fitted in simulator.known}
        self.rounds: list[Round] = []
        self.dropped: set[str] = set()
        self.scanned: set[str] = set()
        self.shapes: dict[str, dict[str, float]] = {}

    def run(self, contestants: list[Effect]) -> None:
        """Add effects until none may be named any more."""
        while len(self.current.simulator.free) < self.settings.most_effects:
            present = {fitted.effect.key for fitted in self.current.simulator.free} | self.dropped
            candidates = [self.candidate(e) for e in contestants if e.key not in present]
            winner = self.likeliest([candidate for candidate in candidates if not candidate.refusal])
            self.rounds.append(Round(tuple(candidates), winner))
            if winner is None:
                return
            self.take(winner)

    def take(self, winner: Candidate) -> None:
        """Fit the simulator with a winner again, and drop what it makes needless."""
        self.current = fit(winner.fit.simulator, self.problem)
        self.scanned.clear()
        self.prune()

    def likeliest(self, admitted: list[Candidate]) -> Candidate | None:
        """Return the one that gains most, or a simpler or likelier cause where nothing tells the two apart."""
        best = max(admitted, key=total_score, default=None)
        if best is None:
            return None
        usual = [c for c in admitted if _is_preferred(c.effect, best.effect)]
        tied = [c for c in usual if not predicts_better(best, c, self.problem.cluster)]
        return max(tied, key=total_score, default=best)

    def candidate(self, effect: Effect, without: Fit | None = None) -> Candidate:
        """Refit with the effect added and compare with the simulator without it."""
        without = without or self.current
        fitted = extend(without, effect, self.problem, self.starts(effect))
        self.shapes[effect.key] = dict(fitted.simulator.effects[-1].values)
        before, after = cross_validated(without, self.fold), cross_validated(fitted, self.fold)
        return self.judged(effect, without, fitted, before, after)

    def starts(self, effect: Effect) -> list[dict[str, float]]:
        """Return where a fit starts: the whole scan until something is named, then what the effect looked like last.

        The scan is repeated once for each effect after every change of the simulator that a round decides on.
        """
        scan = effect.starts()
        if len(scan) > 1 and effect.key in self.scanned:
            return [self.shapes[effect.key], effect.neutral()]
        self.scanned.add(effect.key)
        return scan

    def judged(self, effect: Effect, without: Fit, fitted: Fit, before: Tensor, after: Tensor) -> Candidate:
        """Measure a candidate and say why it may not be named, if so."""
        columns = columns_of(fitted, effect)
        neutral = list(self.resting(effect).values())
        significance = significance_of(fitted, columns, neutral, self.clusters)
        gain = float((log_score(after, fitted.scale) - log_score(before, without.scale)).sum())
        share, interval, energy = self.explained(before, after)
        design_effect = significance.design_effect
        candidate = Candidate(
            effect, fitted, after, gain / design_effect, share, interval, significance.p_value, design_effect
        )
        return replace(candidate, refusal=self.refusal(candidate, energy))

    def explained(self, before: Tensor, after: Tensor) -> tuple[float, tuple[float, float], float]:
        """Return the share of the excess over the noise with its interval, and the energy over the noise's.

        All are of the channel that gains most.
        """
        noise = self.problem.noise.square()
        excess = (self.base.residual.square().mean((0, 1)) - noise).clamp_min(_LEAST_ENERGY * noise)
        energy = (before.square() - after.square()).mean(1)  # (blocks, channels)
        mean = energy.mean(0)
        best = int((mean / excess).argmax())
        groups = energy.new_zeros(self.clusters).index_add(0, self.problem.cluster, energy[:, best])
        error = float(groups.std()) * self.clusters**0.5 / len(energy) if self.clusters > 1 else 0.0
        share, width = float(mean[best] / excess[best]), _Z95 * error / float(excess[best])
        return share, (share - width, share + width), float((mean / noise).max())

    def refusal(self, candidate: Candidate, energy: float) -> str:
        """Return why a candidate may not be named; empty where it may."""
        values = candidate.fit.values[columns_of(candidate.fit, candidate.effect)].tolist()
        resting = self.resting(candidate.effect)
        for value, parameter in zip(values, candidate.effect.parameters, strict=True):
            if value <= parameter.low and parameter.low != resting[parameter.name]:
                return f"{parameter.name} rests on its lower bound"
            if value >= parameter.high:
                return f"{parameter.name} rests on its upper bound"
        if isinstance(candidate.effect, ParameterError) and abs(values[0] - resting["ratio"]) < _LEAST_ERROR:
            return "smaller than the quadrature of the equations can tell"
        if candidate.p_value > self.settings.significance / max(len(self.catalogue), 1):
            return "not significant"
        if candidate.gain <= 0:
            return "does not predict runs it was not fitted on"
        if candidate.share < self.settings.least_share or energy < _LEAST_ENERGY:
            return "explains too little to matter"
        return ""

    def prune(self) -> None:
        """Drop every effect that the others have made needless, the least needed first; it does not come back."""
        self.drop(lambda candidate: bool(candidate.refusal), lambda candidate: candidate.gain)

    def disown(self) -> None:
        """Drop what is less likely there than not: too little evidence, or parameters that follow the manoeuvre."""
        self.drop(lambda candidate: self.presence(candidate) < _BELIEVED, self.presence)

    def drop(self, unwanted: Callable[[Candidate], bool], worth: Callable[[Candidate], float]) -> None:
        """Drop unwanted effects one by one, the one of least worth first, and fit the others again."""
        while judged := [self.alone(fitted.effect) for fitted in self.current.simulator.free]:
            worst = min(filter(unwanted, judged), key=worth, default=None)
            if worst is None:
                return
            self.dropped.add(worst.effect.key)
            self.current = fit(self.without(worst.effect).simulator, self.problem)

    def condense(self) -> None:
        """Put one effect in the place of two parameter errors where it explains as much."""
        simpler = single_cause(self.current, self.catalogue, self.problem, self.known)
        if simpler is None:
            return
        effect, without = simpler
        kept = {fitted.effect.key for fitted in without.simulator.free}
        candidates = tuple(self.candidate(e, without) for e in self.catalogue if e.key not in kept)
        winner = next(candidate for candidate in candidates if candidate.effect.key == effect.key)
        self.rounds.append(Round(candidates, winner))
        self.take(winner)
        self.run(self.catalogue)

    def exchange(self) -> None:
        """Put another effect in the place of a named one wherever it predicts better there.

        The order in which effects entered, and the platform's numbers coming first, must not decide.
        """
        for _ in range(_EXCHANGES):
            better = [
                swap for fitted in self.current.simulator.free if (swap := self.better_than(fitted.effect))
            ]
            if not better:
                return
            _, candidates, winner = max(better, key=lambda swap: swap[0])
            self.rounds.append(Round(candidates, winner))
            self.dropped.discard(winner.effect.key)
            self.take(winner)
            self.run(self.catalogue)

    def better_than(self, effect: Effect) -> tuple[float, tuple[Candidate, ...], Candidate] | None:
        """Return by how much another effect would predict better in the place of a named one, the round, and it."""
        without, own = self.without(effect), self.alone(effect)
        present = {fitted.effect.key for fitted in self.current.simulator.free}
        candidates = tuple(self.candidate(e, without) for e in self.catalogue if e.key not in present)
        admitted = [candidate for candidate in candidates if not candidate.refusal]
        winner = max(admitted, key=total_score, default=None)
        if winner is None or not predicts_better(winner, own, self.problem.cluster):
            return None
        return total_score(winner) - total_score(own), candidates, winner

    def presence(self, candidate: Candidate) -> float:
        """Return the probability that an effect of this kind is there, whichever of its rivals it is."""
        drifts = drifts_of(self.current, candidate.effect, self.problem.blocks, self.problem.cluster)
        parameters = len(candidate.effect.parameters)
        return presence_of(Signs(candidate.gain, parameters, self.clusters, unsteadiness_of(drifts)))

    def resting(self, effect: Effect) -> dict[str, float]:
        """Return the values at which an effect changes nothing: those known before, else none of it."""
        return dict(self.known[effect.key].values) if effect.key in self.known else effect.neutral()

    def without(self, effect: Effect) -> Fit:
        """Return the current fit without an effect, or with what was known of it before."""
        return shrink(self.current, effect, self.problem, self.known.get(effect.key))

    def alone(self, effect: Effect) -> Candidate:
        """Judge an effect of the current simulator as if it had been the last to enter."""
        without = self.without(effect)
        before, after = cross_validated(without, self.fold), cross_validated(self.current, self.fold)
        return self.judged(effect, without, self.current, before, after)

    def result(self) -> Naming:
        """Judge every named effect for the last time and look for those it cannot be told from."""
        named = tuple(self.alone(fitted.effect) for fitted in self.current.simulator.free)
        rivalries = tuple(rivalry for winner in named if (rivalry := self.rivalry(winner)))
        return Naming(self.base, self.current, named, tuple(self.rounds), rivalries)

    def rivalry(self, winner: Candidate) -> Rivalry | None:
        """Return the effects that could stand in for a named one."""
        without = self.without(winner.effect)
        present = {fitted.effect.key for fitted in self.current.simulator.free}
        close = [e for e in self.close_to(winner.effect) if e.key not in present]
        others = [self.candidate(effect, without) for effect in close]
        rivals = rivals_of(winner, [c for c in others if not c.refusal], self.problem.cluster)
        return rivalry_of(winner, [rival for rival in rivals if self.is_needless(rival)], self.clusters)

    def close_to(self, winner: Effect) -> list[Effect]:
        """Return the effects that came close to a winner in the round it won: only they can stand in for it."""
        for turn in reversed(self.rounds):
            if turn.winner is not None and turn.winner.effect.key == winner.key:
                least = 0.5 * turn.winner.share
                return [c.effect for c in turn.candidates if c.share > least]
        return self.catalogue

    def is_needless(self, rival: Candidate) -> bool:
        """Whether the winner leaves nothing for a rival to explain: then both explain the same residual."""
        return self.candidate(rival.effect).gain < _REDUNDANT * rival.gain
