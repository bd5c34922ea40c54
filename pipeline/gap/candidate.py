"""One effect's entry in the competition: where its fit starts, what it is worth, and why it may not be named."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from torch import Tensor

from simgap.effects import ActuatorEffect, Effect, ParameterError
from simgap.gap.fit import Fit, Problem, columns_of
from simgap.gap.residuals import channels_on, noise_of_rows
from simgap.gap.resolution import is_short
from simgap.gap.scoring import cross_validated, folds_of, predictive_score, significance_of
from simgap.gap.settings import Gap
from simgap.simulation import Simulator

_Z95 = 1.96
_LEAST_ERROR = (
    0.002  # of a platform's number: equations of motion sampled a few times per window are no better
)
_IMITATED = "smaller than the quadrature of the equations can tell"
_LEAST_PREDICTED_ENERGY = 0.01  # of the noise's: less than this nobody would see in a prediction
BEYOND_NOISE = 4.0
"""Times the noise's energy: coloured noise may pass for more than the white noise it is measured by."""
_SENT = "motor_command"
_WORSE = 1.2  # times the energy in a channel; nothing that is there makes another equation that much worse
_PRICE = 0.1  # of the logarithm that the other channels' energies fall by, which an imperfect law may cost
FEWEST_MORE = 5
"""So many more clusters than parameters a name needs: errors from fewer are anything."""
_NOTHING = 0.05  # of the strength of what drives a machine, which no machine that was recorded has left of it
_SHARE_OF_REST = (
    0.5  # of what the others leave: it may be little of the whole gap, but it is the cause of the rest
)


@dataclass(frozen=True)
class Candidate:
    """One effect's entry in a round of the competition.

    Attributes:
        effect: what was added to the simulator of that round.
        fit: the refitted simulator.
        score: cross-validated log likelihood of each block with it, up to a constant, (blocks,).
        gain: cross-validated log likelihood gained, corrected for correlated rows.
        channel: of whose residual it explains the greatest part.
        share: of the excess over the noise floor that the others leave there.
        part: of the whole excess there, that of the nominal simulator.
        signal: energy that it explains there over the noise's.
        share_interval: 95 % interval of the share, over clusters of correlated residuals.
        p_value: of the effect's parameters differing from doing nothing.
        design_effect: how many correlated rows count as one.
        refusal: why it may not be named; empty where it may.
    """

    effect: Effect
    fit: Fit
    score: Tensor
    gain: float
    channel: int
    share: float
    part: float
    signal: float
    share_interval: tuple[float, float]
    p_value: float
    design_effect: float
    refusal: str = ""


def _obeying(simulator: Simulator, held: bool) -> Simulator:
    """Return a simulator without what smooths commands that a program sent: of those nothing is noise.

    A multirotor's command is sent whenever it is read; a voltage may have been measured, unless it is `held`.
    """
    effects = tuple(fitted for fitted in simulator.effects if not _smooths(fitted.effect, held))
    return simulator.with_effects(effects)


def _smooths(effect: Effect, held: bool) -> bool:
    return isinstance(effect, ActuatorEffect) and effect.smooths_commands and (held or _SENT in effect.needs)


class Starts:
    """Where the fit of each effect starts."""

    def __init__(self, signals: Mapping[str, Tensor]) -> None:
        """Prepare for what was recorded."""
        self.signals = signals
        self.scanned: set[str] = set()
        self.shapes: dict[str, dict[str, float]] = {}

    def of(self, effect: Effect) -> list[dict[str, float]]:
        """Return where a fit starts: the whole scan until something is named, then what the effect looked like last.

        The scan is repeated once for each effect after every change of the simulator that a round decides on; every
        time where what the effect looked like may lie on the other side of a kink.
        """
        scan = effect.starts_in(self.signals)
        if len(scan) > 1 and not effect.kinked and effect.key in self.scanned:
            return [self.shapes[effect.key], effect.neutral()]
        self.scanned.add(effect.key)
        return scan

    def note(self, fitted: Fit) -> None:
        """Remember what the effect that entered last looks like."""
        last = fitted.simulator.effects[-1]
        self.shapes[last.effect.key] = dict(last.values)

    def forget(self) -> None:
        """Scan every effect again: the simulator has changed."""
        self.scanned.clear()


class Judge:
    """Measures candidates against the noise floor and the runs left out."""

    def __init__(
        self,
        problem: Problem,
        settings: Gap,
        base: Fit,
        contestants: int,
        resting: Mapping[str, dict[str, float]],
    ) -> None:
        """Prepare to judge.

        Args:
            problem: blocks, windows, noise and clusters.
            settings: of the gap engine.
            base: fit of the nominal simulator.
            contestants: how many effects compete, for which the test of each has to allow.
            resting: values of the effects that were known before.
        """
        self.problem, self.settings, self.base = problem, settings, base
        self.contestants, self.resting = contestants, resting
        self.fold = folds_of(problem.blocks, settings.folds)
        self.clusters = int(problem.cluster.max()) + 1
        self.last: tuple[Fit, Tensor] | None = None

    def __call__(self, effect: Effect, without: Fit, fitted: Fit) -> Candidate:
        """Measure a candidate and say why it may not be named, if so."""
        before, after = self.before(without), self.left_out(fitted)
        columns = columns_of(fitted, effect)
        neutral = list(self.rest(effect).values())
        significance = significance_of(fitted, columns, neutral, self.clusters)
        score = predictive_score(after, self.problem.noise)
        gain = float((score - predictive_score(before, self.problem.noise)).sum())
        energy = (before.square() - after.square()).mean(1)  # (blocks, channels)
        energies = energy.mean(0)
        channel = int((energies / without.scale.square()).argmax())
        share, interval = self.share(energy[:, channel], self.excess(before)[channel])
        candidate = Candidate(
            effect=effect,
            fit=fitted,
            score=score,
            gain=gain / significance.design_effect,
            channel=channel,
            share=share,
            part=float(energies[channel] / self.excess(self.base.residual)[channel]),
            signal=float(energies[channel] / self.problem.noise[channel].square()),
            share_interval=interval,
            p_value=significance.p_value,
            design_effect=significance.design_effect,
        )
        spoilt = self.spoilt(before, after, self.acts_in(fitted, columns, neutral))
        return replace(candidate, refusal=self.refusal(candidate, energies) or spoilt)

    def left_out(self, fit: Fit) -> Tensor:
        """Return residuals of folds left out, (blocks, rows, channels), with the noise that a fit has silenced.

        An input that is mostly noise is best foretold by equations that hardly listen to it. What they pass on less of
        its noise than those of the simulator before is no merit, and counts as left. Smoothing what a program sent is
        one: that holds no noise, however much it jumps.
        """
        heard = _obeying(fit.simulator, self.problem.blocks.held)
        passed_on = noise_of_rows(heard, self.problem.blocks, self.problem.functions)
        silenced = (self.problem.noise.square() - passed_on.square()).clamp_min(0.0)
        return (cross_validated(fit, self.fold).square() + silenced).sqrt()

    def before(self, without: Fit) -> Tensor:
        """Return the same of the simulator without the effect; all candidates of a round have that in common."""
        if self.last is None or self.last[0] is not without:
            self.last = without, self.left_out(without)
        return self.last[1]

    def excess(self, residual: Tensor) -> Tensor:
        """Return the energy of residuals over the noise's in each channel, (channels,)."""
        noise = self.problem.noise.square()
        return (residual.square().mean((0, 1)) - noise).clamp_min(_LEAST_PREDICTED_ENERGY * noise)

    def share(self, energy: Tensor, excess: Tensor) -> tuple[float, tuple[float, float]]:
        """Return the share of an excess that the energy explained in each block (blocks,) is, and its interval."""
        groups = energy.new_zeros(self.clusters).index_add(0, self.problem.cluster, energy)
        error = float(groups.std()) * self.clusters**0.5 / len(energy) if self.clusters > 1 else 0.0
        share, width = float(energy.mean() / excess), _Z95 * error / float(excess)
        return share, (share - width, share + width)

    def refusal(self, candidate: Candidate, energies: Tensor) -> str:
        """Return why a candidate may not be named; empty where it may."""
        effect, fit = candidate.effect, candidate.fit
        names = (parameter.name for parameter in effect.parameters)
        values = dict(zip(names, fit.values[columns_of(fit, effect)].tolist(), strict=True))
        constants = fit.simulator.constants()
        refusal = (
            self.bound(effect, values)
            or _parameter_without_trace(candidate)
            or self.unresolved(effect, values, constants)
        )
        if refusal:
            return refusal
        blocks = self.problem.blocks
        if limit := effect.limit(values, blocks.signals | blocks.resolution, constants):
            return f"comes down to {limit} here"
        if self.clusters < fit.jacobian.shape[-1] + FEWEST_MORE:
            return "too little was recorded to tell"
        if candidate.p_value > self.settings.significance / max(self.contestants, 1):
            return "not significant"
        if candidate.gain <= 0:
            return "does not predict runs it was not fitted on"
        if why := effect.unphysical(values, constants) or self.silenced(effect, fit.simulator):
            return why
        seen = energies > _LEAST_PREDICTED_ENERGY * self.problem.noise.square()
        if not seen.any() or not self.matters(candidate):
            return "explains too little to matter"
        return "" if (seen & (energies > self.problem.quadrature.square())).any() else _IMITATED

    def acts_in(self, fitted: Fit, columns: list[int], neutral: list[float]) -> Tensor:
        """Return in which channels an effect itself, not what is fitted beside it, makes a difference, (channels,)."""
        change = fitted.values[columns] - fitted.values.new_tensor(neutral)
        own = (fitted.jacobian[..., columns] @ change).square().mean((0, 1))
        return own > _LEAST_PREDICTED_ENERGY * self.problem.noise.square()

    def spoilt(self, before: Tensor, after: Tensor, acts: Tensor) -> str:
        """Return which channel an effect makes worse on folds left out, if any, by more than noise may.

        Where it does not act itself, another effect had made up for something else before, and now may not any more.

        Args:
            before: residuals without it, (blocks, rows, channels).
            after: with it.
            acts: in which channels it makes a difference, (channels,).
        """
        least = BEYOND_NOISE * self.problem.noise.square()
        energies = [residual.square().mean((0, 1)).maximum(least) for residual in (before, after)]
        growth = (energies[1] / energies[0]).log()
        lost, won = growth.clamp_min(0.0) * acts, -growth.clamp_max(0.0)
        worst = int(lost.argmax())
        if lost[worst] <= math.log(_WORSE) or lost.sum() <= _PRICE * won.sum():
            return ""
        return f"makes {channels_on(self.base.simulator, self.problem.blocks)[worst].name} worse"

    def bound(self, effect: Effect, values: dict[str, float]) -> str:
        """Return which bound a parameter rests on, if it does and that is not where it changes nothing."""
        resting = self.rest(effect)
        for parameter in effect.parameters:
            value = values[parameter.name]
            if value <= parameter.low and parameter.low != resting[parameter.name]:
                return f"{parameter.name} rests on its lower bound"
            if value >= parameter.high:
                return f"{parameter.name} rests on its upper bound"
        return ""

    def unresolved(self, effect: Effect, values: dict[str, float], constants: dict[str, Any]) -> str:
        """Return what resolves no value as small as an effect's, if that is so.

        Args:
            effect: of the candidate.
            values: its parameters.
            constants: of the fitted simulator.
        """
        resting = self.rest(effect)
        if effect.key in self.resting and self.is_short(effect, values, constants):
            return "changes by less than samples can tell"
        if isinstance(effect, ParameterError) and abs(values["ratio"] - resting["ratio"]) < _LEAST_ERROR:
            return _IMITATED
        return ""

    def is_short(self, effect: Effect, values: Mapping[str, float], constants: dict[str, Any]) -> bool:
        """Whether an effect makes something late by less than samples can tell, beside what was known before."""
        late, known = (effect.lateness(each, constants) for each in (values, self.rest(effect)))
        return is_short(late - known, self.problem.blocks.time_step)

    def silenced(self, effect: Effect, simulator: Simulator) -> str:
        """Return that an effect takes away what drives the machine, if it does: whatever were left would do as well."""
        if not isinstance(effect, ActuatorEffect):
            return ""
        blocks = self.problem.blocks
        others = tuple(fitted for fitted in simulator.effects if fitted.effect.key != effect.key)
        without, after = (
            each.along_time(blocks.signals, blocks.time_step)
            for each in (simulator.with_effects(others), simulator)
        )
        if any(_is_gone(after[name], without[name]) for name in without.keys() & after.keys()):
            return "takes away all that drives the machine"
        return ""

    def matters(self, candidate: Candidate) -> bool:
        """Whether a candidate explains enough of the whole gap, or else most of what is left, and more than noise."""
        if candidate.share < self.settings.least_share:
            return False
        rest = candidate.share >= _SHARE_OF_REST and candidate.signal > 1.0
        return candidate.part >= self.settings.least_share or rest

    def rest(self, effect: Effect) -> dict[str, float]:
        """Return the values at which an effect changes nothing: those known before, else none of it."""
        return self.resting.get(effect.key, effect.neutral())


def _is_gone(after: Tensor, before: Tensor) -> bool:
    """Whether of a signal (blocks, samples, ...) next to nothing is left."""
    return float(after.square().mean()) < _NOTHING**2 * float(before.square().mean())


def _parameter_without_trace(candidate: Candidate) -> str:
    """Return which parameter leaves no trace in the recording, if one does: any value that it may have serves."""
    effect, fit = candidate.effect, candidate.fit
    for parameter, column in zip(effect.parameters, columns_of(fit, effect), strict=True):
        error = float(fit.covariance[column, column].clamp_min(0.0).sqrt())
        if error > parameter.high - parameter.low or not fit.jacobian[..., column].any():
            return f"{parameter.name} makes no difference here"
    return ""
