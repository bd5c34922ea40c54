"""How probable the recorded rows are under a fitted simulator.

What a block counts is in `simgap.equations.temper`.

Residuals of an axis are measured against the smaller side of its equation, and elsewhere against what the nominal
simulator leaves: an equation can be met by making all of its terms small (a dead zone as wide as the commands).
So a channel counts by the worse one of two regressions, of the commands on the motion and of the motion on the
commands. They bound the truth where both hold errors (Frisch 1934, Statistical confluence analysis, for a slope).
"""

from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.effects import ActuatorEffect, Effect, MeasurementEffect
from simgap.equations.fit import Fit
from simgap.equations.passed_noise import PassedNoise
from simgap.equations.problem import Problem
from simgap.equations.recent import Recent
from simgap.equations.row_noise import TOLERATED, noise_of_rows
from simgap.equations.temper import Temper
from simgap.simulation import Simulator

INEXACT = 0.05
"""Of what a law explains: textbook laws of friction and drag hold to a twentieth, so that what is left below it is
evidence for no other one."""
_KEPT = 8
"""Simulators whose passed noise is remembered."""
_NOTHING = 1e-24
"""Mean square of what does not move at all."""


@dataclass(frozen=True)
class Likelihood:
    """The tempered log likelihood of a recording under one fitted simulator.

    Attributes:
        channels: log likelihood of each channel up to a constant that all hypotheses share, (channels,).
        weight: what each row's squared residual counts in it, (blocks, channels): the curvature of the likelihood.
        left: mean square of the residual in each block, at least the noise's, (blocks, channels).
        noise: mean square of the noise there, with what no law is exact to, (blocks, channels).
    """

    channels: Tensor
    weight: Tensor
    left: Tensor
    noise: Tensor

    @property
    def value(self) -> float:
        """The log likelihood of all channels."""
        return float(self.channels.sum())

    @property
    def excess(self) -> Tensor:
        """Mean square of the residual over the noise's, at least 1, (channels,)."""
        return (self.left / self.noise).mean(0)

    def scaled(self, factor: Tensor) -> "Likelihood":
        """Return the same likelihood in terms of rows that are larger by a factor, (channels,)."""
        size = factor**2
        return Likelihood(self.channels, self.weight / size, self.left * size, self.noise * size)

    def lower(self, other: "Likelihood") -> "Likelihood":
        """Return the lower one of two likelihoods, channel by channel."""
        mine = self.channels <= other.channels
        parts = ("channels", "weight", "left", "noise")
        return Likelihood(*(torch.where(mine, getattr(self, part), getattr(other, part)) for part in parts))


class LikelihoodOf:
    """The likelihood of fits to one problem; what only depends on the recording is computed once."""

    def __init__(self, problem: Problem, nominal: Simulator) -> None:
        """Prepare for fits of simulators that extend a nominal one."""
        self.problem = problem
        self.base = problem.residual(nominal)
        self.temper = problem.counted or counted_beside(problem, self.base)
        self.untouched = self._untouched(nominal)
        self.passed = PassedNoise(problem.blocks, problem.functions)
        self._passed_bare = Recent[Tensor](_KEPT)

    def __call__(self, fitted: Fit) -> Likelihood:
        """Return the likelihood of a fit: of each channel, that of the side of its equation on which it is lower.

        Errors lie in the commands or in the motion, and nobody knows in which. What is small on one side alone is so
        because all terms are small there.
        """
        simulator = fitted.simulator
        noise, silenced = self.noise(fitted)
        energy, factor = self.energy(simulator), self.problem.factor(simulator)
        if self.problem.gain is None:
            # Rows enlarged by a factor are rows that are measured against so much less energy.
            return self._on_side(fitted.residual, noise, silenced, energy / self._enlargement(noise) ** 2)
        by_commands = self._on_side(fitted.residual, noise, silenced, energy)
        by_motion = self._on_side(fitted.residual / factor, noise / factor**2, silenced / factor**2, energy)
        return by_commands.lower(by_motion.scaled(factor))

    def _on_side(self, residual: Tensor, noise: Tensor, silenced: Tensor, energy: Tensor) -> Likelihood:
        """Return the likelihood of a residual that is measured against an energy."""
        explained = (self.base - residual).square().mean(1)
        if self.problem.is_axis:
            explained = torch.minimum(explained, energy)
        silent = silenced / noise
        noise = noise + INEXACT**2 * explained
        left = torch.maximum(residual.square().mean(1) + silenced, noise)
        mixture = self.temper.mixture(left, noise)
        sound = 1.0 - self.temper.missed(mixture, left, noise)
        chance = self.temper.by_chance(TOLERATED) * silent * sound
        value = self.temper.value_of(mixture, left, noise) - chance.sum(0)
        value = value + 0.5 * self.temper.lasting * len(left) * energy.log() + self.untouched
        return Likelihood(value, self.temper.weight_of(mixture, left, noise), left, noise)

    def _untouched(self, nominal: Simulator) -> Tensor:
        """Return the log likelihood of the samples that an estimated driver has used up, (channels,).

        They count as the nominal simulator leaves them, noise included: an estimate is no evidence for itself.
        """
        temper = self.temper
        noise = (TOLERATED * self.problem.noise.square()).clamp_min(
            _NOTHING
        ) + self.problem.quadrature.square()
        left = torch.maximum(self.base.square().mean(1), noise)
        return -0.5 * temper.taken * (left / self.energy(nominal)).log().sum(0)

    def noise(self, fitted: Fit) -> tuple[Tensor, Tensor]:
        """Return the mean square of the noise that a simulator passes on, and of what it filters out, (channels,) each.

        An effect that filters a noisy input lowers the residual and explains nothing: the noise that it removes is
        added again, with what it would cost by chance in a block of noise alone. Commands that a program sent hold no
        noise, so that filters on them remove none. Where an effect takes an input away altogether, its noise goes with
        it.
        """
        simulator = fitted.simulator
        blocks, functions = self.problem.blocks, self.problem.functions
        bare = simulator.with_effects(tuple(f for f in simulator.effects if not _filters(f.effect)))
        size = self.problem.factor(simulator) ** 2
        nominal = (self.problem.loudness(simulator) * self.problem.noise).square()
        # A simulator whose forces jump looks noisy by itself: the quieter one shows what the sensors' noise can be.
        floor = torch.minimum(size * noise_of_rows(bare, blocks, functions).square(), nominal)
        removed = torch.zeros_like(floor)
        if bare != simulator:
            heard, whole = (
                self.passed(simulator),
                self._passed_bare.of(bare.effects, lambda: self.passed(bare)),
            )
            removed = torch.where(whole > 0.0, 1.0 - heard / whole, 0.0).clamp_min(0.0)
        silenced = floor * removed
        # Rows cannot hold more noise than is left of them.
        floor = torch.minimum(floor, fitted.residual.square().mean((0, 1)) + silenced)
        return TOLERATED * floor.clamp_min(_NOTHING) + self.problem.quadrature.square(), silenced

    def _enlargement(self, noise: Tensor) -> Tensor:
        """Return the factors of rows at which their noise is that of the nominal simulator, at least 1, (channels,).

        Where rows are not put on the side of the commands, a small gain of a noisy input would make all errors small.
        """
        return (TOLERATED * self.problem.noise.square() / noise).sqrt().clamp_min(1.0)

    def energy(self, simulator: Simulator) -> Tensor:
        """Return the mean square that residuals are measured against, (channels,).

        On an axis it is that of the smaller side of its equation: what commands do in the nominal simulator, or what
        is left of a simulator without commands. Elsewhere it is that of a row of one unit: what the nominal simulator
        leaves depends on when commands act, and the worst timing would gain most.
        """
        gain = self.problem.gain
        if gain is None or not self.problem.is_axis:
            return torch.ones_like(self.problem.noise)
        return gain.smaller_side(simulator).clamp_min(_NOTHING)


def counted_beside(problem: Problem, base: Tensor) -> Temper:
    """Return how rows count where a law would have to explain what the nominal simulator leaves.

    It would not be exact, and what it leaves then lasts as a discrepancy does. This is the same for all hypotheses: a
    count that followed what each explains would reward it for explaining more.

    Args:
        problem: the fitted rows.
        base: what the nominal simulator leaves of them, (blocks, rows, channels).
    """
    noise = problem.noise.square().clamp_min(_NOTHING)
    return problem.temper.beside(noise, INEXACT**2 * base.square().mean(1))


def _filters(effect: Effect) -> bool:
    """Whether an effect mixes samples of a signal: it averages, delays or shifts it between samples."""
    mixing = isinstance(effect, ActuatorEffect) and (effect.remembers or effect.smooths_commands)
    return mixing or isinstance(effect, MeasurementEffect)
