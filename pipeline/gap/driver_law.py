"""The law of a slow driver that was not recorded: a line in time for each run, and a fall with the load."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from scipy.optimize import nnls
from scipy.signal import lfilter
from torch import Tensor

from simgap.effects import Effect
from simgap.equations.problem import Problem
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.blocks import Blocks

_STEP = 0.01  # relative step of the finite difference in a driver
_PASSES = 2  # a thrust depends on the square of a voltage
_LAGS = (1.0, 3.0, 10.0, 30.0)
"""s; of what follows the load late: the pairs of resistor and capacitor of a battery, windings that warm up."""


@dataclass(frozen=True)
class DriverLaw:
    """The model of a latent input: a level or a line in time per run, minus a fall with the load, at once and late.

    Sources: Chen & Rincón-Mora 2006, Accurate electrical battery model, figure 2, for the source, the series resistance
    and the pair of resistor and capacitor; a winding of one heat capacity warms up as such a pair does.

    Attributes:
        name: of the driver.
        acting: the simulator in which it acts, with the effects that it drives.
        load: the effect that defines its load.
        rest: its value where its effects do nothing, in its unit.
        at_once: by how much it falls per load, in its unit; the same in all runs.
        late: by how much it falls per load in the end, beside that, in its unit; the same in all runs.
        lag: time constant of the late fall, s.
    """

    name: str
    acting: Simulator
    load: Effect
    rest: float
    at_once: float = 0.0
    late: float = 0.0
    lag: float = _LAGS[0]

    @classmethod
    def of(cls, effects: Sequence[FittedEffect], problem: Problem, simulator: Simulator) -> "DriverLaw":
        """Fit the law of the driver that some effects share to the runs of a problem.

        Args:
            effects: those that it drives, with the values that they act with.
            problem: the runs, windows and noise.
            simulator: everything else that is known.
        """
        first = effects[0].effect
        where = first.driver_at_rest
        rest = float(first.defaults()[where] if where in first.defaults() else simulator.constants()[where])
        law = cls(first.driver, simulator.with_effects((*simulator.effects, *effects)), first, rest)
        load = law._load(problem.blocks)
        return law if load is None else law._falling(problem, load)

    def along(self, problem: Problem) -> Tensor:
        """Return the driver along the blocks, (blocks, samples with margins), in its unit.

        Within a run it is a level or a line in time, minus the fall with the load. For each stretch it is fitted by
        least squares to the other stretches of the run, so that no stretch contributes to its own estimate.
        """
        load = self._load(problem.blocks)
        fallen: Tensor | float = 0.0
        if load is not None:
            fallen = self.at_once * load + self.late * lagged(problem.blocks, load, self.lag)
        line = constant(problem.blocks, self.rest)
        for _ in range(_PASSES):
            before = self._residual(problem, line - fallen)
            answer = self._answer(problem, line - fallen, torch.ones_like(line), before)
            scale, _ = problem.weigh(before)
            information = (answer / scale).square().sum((1, 2))
            score = (answer * before / scale.square()).sum((1, 2))
            shown = problem.blocks.inner(line).mean(1) + score / information.clamp_min(1e-300)
            line = _interpolated(problem, shown, information, self.rest)
        return line - fallen

    def _falling(self, problem: Problem, load: Tensor) -> "DriverLaw":
        """Return the law with the falls that fit best, beside a line in time of each run."""
        series = constant(problem.blocks, self.rest)
        residual = self._residual(problem, series)
        level = self._answer(problem, series, torch.ones_like(series), residual)
        at_once = self._answer(problem, series, -load, residual)
        found = []
        for lag in _LAGS:
            late = self._answer(problem, series, -lagged(problem.blocks, load, lag), residual)
            triangle = _beside_lines(problem, level, [at_once, late, residual])
            falls, left = nnls(triangle[:, :2].numpy(), triangle[:, 2].numpy())
            found.append((left, lag, *falls.tolist()))
        _, lag, at_once_falls, late_falls = min(found)
        return replace(self, at_once=at_once_falls, late=late_falls, lag=lag)

    def _residual(self, problem: Problem, series: Tensor) -> Tensor:
        """Return what is left under a driver, (blocks, rows, channels)."""
        return replace(problem, blocks=with_signal(problem.blocks, self.name, series)).residual(self.acting)

    def _answer(self, problem: Problem, series: Tensor, direction: Tensor, residual: Tensor) -> Tensor:
        """Return how the prediction answers to a change of the driver, from the residual without it."""
        step = _STEP * abs(self.rest) / float(direction.abs().max().clamp_min(1e-300))
        return (residual - self._residual(problem, series + step * direction)) / step

    def _load(self, blocks: Blocks) -> Tensor | None:
        resting = with_signal(blocks, self.name, constant(blocks, self.rest))
        signals = self.acting.along_time(resting.signals, blocks.time_step)
        return self.load.load(signals, self.acting.constants())


def lagged(blocks: Blocks, load: Tensor, lag: float) -> Tensor:
    """Return a load through a first-order lag, (blocks, samples with margins).

    It begins at zero with the first block of each run. Between two blocks the load is taken to be their mean.

    Args:
        blocks: of the load.
        load: (blocks, samples with margins).
        lag: time constant, s.
    """
    kept, duration = math.exp(-blocks.time_step / lag), blocks.samples * blocks.time_step
    out, mean = torch.zeros_like(load), blocks.inner(load).mean(1).tolist()
    last = blocks.samples - 1  # before the margin of the block that follows
    for run in torch.unique(blocks.run):
        mine = torch.nonzero(blocks.run == run).flatten().tolist()
        state, end, before = 0.0, float(blocks.start[mine[0]]), mean[mine[0]]
        for block in mine:
            between = 0.5 * (before + mean[block])
            gap = max(float(blocks.start[block]) - end, 0.0)
            state = between + (state - between) * math.exp(-gap / lag)
            first = blocks.margin if block == mine[0] else 0  # what is before a run was never recorded
            acting = load[block, first:].numpy()
            series, _ = lfilter([1.0 - kept], [1.0, -kept], acting, zi=[kept * state])
            out[block, first:] = torch.from_numpy(series)
            state, end, before = float(out[block, last]), float(blocks.start[block]) + duration, mean[block]
    return out


def _beside_lines(problem: Problem, level: Tensor, columns: Sequence[Tensor]) -> Tensor:
    """Return weighted columns without what a line in time of each run explains, as the triangle R of their QR."""
    weight = (1.0 / problem.weigh(columns[-1])[0]).expand_as(level)
    time = problem.blocks.start[:, None, None]
    rest = []
    for run in torch.unique(problem.blocks.run):
        mine = problem.blocks.run == run
        line = torch.stack([level[mine], level[mine] * (time[mine] - time[mine].mean())], dim=-1)
        own = torch.stack([column[mine] for column in columns], dim=-1)
        basis, own = ((each * weight[mine][..., None]).flatten(0, -2) for each in (line, own))
        basis = torch.linalg.qr(basis)[0]
        rest.append(own - basis @ (basis.T @ own))
    return torch.linalg.qr(torch.cat(rest), mode="r")[1]


def _interpolated(problem: Problem, shown: Tensor, information: Tensor, rest: float) -> Tensor:
    """Return levels or lines in time, whichever predicts left-out stretches better, (blocks, samples with margins)."""
    found = [_lines(problem, shown, information, rest, sloping) for sloping in (False, True)]
    missed = [
        float((information * (problem.blocks.inner(line).mean(1) - shown).square()).sum()) for line in found
    ]
    return found[1] if missed[1] < missed[0] else found[0]


def _lines(problem: Problem, shown: Tensor, information: Tensor, rest: float, sloping: bool) -> Tensor:
    """Return for each stretch the line through what the others of its run show, (blocks, samples with margins)."""
    blocks, cluster = problem.blocks, problem.cluster
    series = constant(blocks, rest)
    length = series.shape[1]
    offset = (torch.arange(length, dtype=torch.float64) - 0.5 * (length - 1)) * blocks.time_step
    for stretch in torch.unique(cluster).tolist():
        mine = cluster == stretch
        others = (blocks.run == blocks.run[mine][0]) & ~mine
        weight, time = information[others], blocks.start[others]
        total = weight.sum()
        if float(total) > 0:
            centre, level = (weight * time).sum() / total, (weight * shown[others]).sum() / total
            spread = (weight * (time - centre).square()).sum().clamp_min(1e-300)
            slope = (weight * (time - centre) * (shown[others] - level)).sum() / spread * float(sloping)
            series[mine] = level + slope * (blocks.start[mine, None] + offset - centre)
    return series


def constant(blocks: Blocks, value: float) -> Tensor:
    """Return a series that stays, (blocks, samples with margins)."""
    length = next(iter(blocks.signals.values())).shape[1]
    return torch.full((len(blocks), length), value, dtype=torch.float64)


def with_signal(blocks: Blocks, name: str, series: Tensor) -> Blocks:
    """Return the blocks with one more signal."""
    return replace(blocks, signals={**blocks.signals, name: series})
