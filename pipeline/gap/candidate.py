"""A candidate effect in a round of the selection: its starts, its score, and the reason if it is refused."""

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
_LEAST_ERROR = 0.002  # relative error of a platform number; the discretisation is no better
_IMITATED = "smaller than the discretisation error of the equations"
_LEAST_PREDICTED_ENERGY = 0.01  # of the noise energy; less does not show in a prediction
BEYOND_NOISE = 4.0
"""Times the noise energy, above which a gap counts: coloured noise may reach it."""
_SENT = "motor_command"
_WORSE = 1.2  # times the energy of another channel, which a true effect does not exceed
_PRICE = 0.1  # of the fall of ln(energy) in other channels, which an imperfect law may cost
FEWEST_MORE = 5
"""Clusters that are needed beyond the number of parameters: standard errors from fewer are unreliable."""
_NOTHING = 0.05  # of the RMS of an actuator signal; a recorded machine has more left
_SHARE_OF_REST = 0.5  # of what the others leave; such an effect counts even if it is little of the whole gap


@dataclass(frozen=True)
class Candidate:
    """One candidate effect in a round of the selection.

    Attributes:
        effect: effect that was added to the simulator of that round.
        fit: the refitted simulator.
        score: cross-validated log likelihood of each block with it, up to a constant, (blocks,).
        gain: gain in cross-validated log likelihood, divided by the design effect.
        channel: index of the channel of whose residual it explains most.
        share: explained share of the energy above the noise that the other effects leave there.
        part: the same of what the nominal simulator leaves there.
        signal: explained energy there over the noise energy.
        share_interval: 95 % interval of the share, over clusters of correlated residuals.
        p_value: of the Wald test of its parameters against their neutral values.
        design_effect: ratio of robust to naive variance, at least 1.
        refusal: reason why it is refused; empty if it is not.
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
    """Return a simulator without the effects that filter commands sent by a program: such commands hold no noise.

    A multirotor's command is always sent; a voltage may have been measured, unless it is `held`.
    """
    effects = tuple(fitted for fitted in simulator.effects if not _smooths(fitted.effect, held))
    return simulator.with_effects(effects)


def _smooths(effect: Effect, held: bool) -> bool:
    return isinstance(effect, ActuatorEffect) and effect.smooths_commands and (held or _SENT in effect.needs)


class Starts:
    """The starting values of each effect's fit."""

    def __init__(self, signals: Mapping[str, Tensor]) -> None:
        """Prepare for what was recorded."""
        self.signals = signals
        self.scanned: set[str] = set()
        self.shapes: dict[str, dict[str, float]] = {}

    def of(self, effect: Effect) -> list[dict[str, float]]:
        """Return the starting values: the whole grid once after every change of the simulator, else the last fit.

        An effect with a kink always starts from the whole grid, since its last values may lie beyond the kink.
        """
        scan = effect.starts_in(self.signals)
        if len(scan) > 1 and not effect.kinked and effect.key in self.scanned:
            return [self.shapes[effect.key], effect.neutral()]
        self.scanned.add(effect.key)
        return scan

    def note(self, fitted: Fit) -> None:
        """Remember the values of the effect that entered last."""
        last = fitted.simulator.effects[-1]
        self.shapes[last.effect.key] = dict(last.values)

    def forget(self) -> None:
        """Use the whole grid again: the simulator has changed."""
        self.scanned.clear()


class Judge:
    """Scores candidates on left-out runs and refuses those that may not be named."""

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
        """Score a candidate and set the reason if it is refused."""
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
        """Return residuals of left-out folds, (blocks, rows, channels), plus the input noise that a fit filters out.

        An effect that filters a noisy input reduces the residual without explaining anything. The noise that it
        removes is therefore added again. Filters on commands that a program sent are exempt: those hold no noise.
        """
        heard = _obeying(fit.simulator, self.problem.blocks.held)
        passed_on = noise_of_rows(heard, self.problem.blocks, self.problem.functions)
        silenced = (self.problem.noise.square() - passed_on.square()).clamp_min(0.0)
        return (cross_validated(fit, self.fold).square() + silenced).sqrt()

    def before(self, without: Fit) -> Tensor:
        """Return the same without the effect; all candidates of a round share it."""
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
        """Return the reason why a candidate is refused; empty if it is not."""
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
            return f"equals {limit} in this recording"
        if self.clusters < fit.jacobian.shape[-1] + FEWEST_MORE:
            return "too little data for this number of parameters"
        if candidate.p_value > self.settings.significance / max(self.contestants, 1):
            return "not significant"
        if candidate.gain <= 0:
            return "does not improve the prediction of left-out runs"
        if why := effect.unphysical(values, constants) or self.silenced(effect, fit.simulator):
            return why
        seen = energies > _LEAST_PREDICTED_ENERGY * self.problem.noise.square()
        if not seen.any() or not self.matters(candidate):
            return "explains too little to matter"
        return "" if (seen & (energies > self.problem.quadrature.square())).any() else _IMITATED

    def acts_in(self, fitted: Fit, columns: list[int], neutral: list[float]) -> Tensor:
        """Return in which channels the effect itself, without the refit of others, makes a difference, (channels,)."""
        change = fitted.values[columns] - fitted.values.new_tensor(neutral)
        own = (fitted.jacobian[..., columns] @ change).square().mean((0, 1))
        return own > _LEAST_PREDICTED_ENERGY * self.problem.noise.square()

    def spoilt(self, before: Tensor, after: Tensor, acts: Tensor) -> str:
        """Return which channel an effect makes worse on left-out folds, if any.

        A channel in which the effect does not act is ignored: there another effect was biased before.

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
        return f"makes the prediction of {channels_on(self.base.simulator, self.problem.blocks)[worst].name} worse"

    def bound(self, effect: Effect, values: dict[str, float]) -> str:
        """Return which bound a parameter ends on, unless that is its neutral value."""
        resting = self.rest(effect)
        for parameter in effect.parameters:
            value = values[parameter.name]
            if value <= parameter.low and parameter.low != resting[parameter.name]:
                return f"the fit of {parameter.name} ends on its lower bound"
            if value >= parameter.high:
                return f"the fit of {parameter.name} ends on its upper bound"
        return ""

    def unresolved(self, effect: Effect, values: dict[str, float], constants: dict[str, Any]) -> str:
        """Return a reason if an effect's value is too small to be resolved.

        Args:
            effect: of the candidate.
            values: its parameters.
            constants: of the fitted simulator.
        """
        resting = self.rest(effect)
        if effect.key in self.resting and self.is_short(effect, values, constants):
            return "differs from the known value by less than the sampling can show"
        if isinstance(effect, ParameterError) and abs(values["ratio"] - resting["ratio"]) < _LEAST_ERROR:
            return _IMITATED
        return ""

    def is_short(self, effect: Effect, values: Mapping[str, float], constants: dict[str, Any]) -> bool:
        """Whether an effect adds a delay that is shorter than the sampling can show."""
        late, known = (effect.lateness(each, constants) for each in (values, self.rest(effect)))
        return is_short(late - known, self.problem.blocks.time_step)

    def silenced(self, effect: Effect, simulator: Simulator) -> str:
        """Return a reason if an effect removes nearly all of an actuator signal."""
        if not isinstance(effect, ActuatorEffect):
            return ""
        blocks = self.problem.blocks
        others = tuple(fitted for fitted in simulator.effects if fitted.effect.key != effect.key)
        without, after = (
            each.along_time(blocks.signals, blocks.time_step)
            for each in (simulator.with_effects(others), simulator)
        )
        if any(_is_gone(after[name], without[name]) for name in without.keys() & after.keys()):
            return "removes nearly all of what drives the machine"
        return ""

    def matters(self, candidate: Candidate) -> bool:
        """Whether a candidate explains enough of the whole gap, or most of the rest and more than the noise."""
        if candidate.share < self.settings.least_share:
            return False
        rest = candidate.share >= _SHARE_OF_REST and candidate.signal > 1.0
        return candidate.part >= self.settings.least_share or rest

    def rest(self, effect: Effect) -> dict[str, float]:
        """Return the values at which an effect changes nothing: those known before, else its neutral values."""
        return self.resting.get(effect.key, effect.neutral())


def _is_gone(after: Tensor, before: Tensor) -> bool:
    """Whether of a signal (blocks, samples, ...) next to nothing is left."""
    return float(after.square().mean()) < _NOTHING**2 * float(before.square().mean())


def _parameter_without_trace(candidate: Candidate) -> str:
    """Return a reason if the recording does not depend on a parameter."""
    effect, fit = candidate.effect, candidate.fit
    for parameter, column in zip(effect.parameters, columns_of(fit, effect), strict=True):
        error = float(fit.covariance[column, column].clamp_min(0.0).sqrt())
        if error > parameter.high - parameter.low or not fit.jacobian[..., column].any():
            return f"{parameter.name} makes no difference in this recording"
    return ""
