"""Latent inputs: unrecorded slow drivers (battery voltage, motor temperature), estimated from the motion."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.effects import Effect, ParameterError
from simgap.gap.candidates import allowed, available_signals
from simgap.gap.fit import Problem
from simgap.gap.hypothesis import Hypothesis
from simgap.gap.reading import Reading
from simgap.gap.scoring import independent_clusters
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.blocks import Blocks

_DRIVER_STEP = 0.01  # relative step of the finite difference in a driver
_UNRECORDED = 0.1
"""Odds that a driver which nobody recorded changed enough to be seen: who expects that records it."""
_DRIVER_PASSES = 2  # a thrust depends on the square of a voltage


def driven_readings(centre: Hypothesis, settings: Gap) -> list[tuple[Reading, list[Effect]]]:
    """Return readings in which a driver that was not recorded is estimated, each with the effects that it drives.

    A driver that changes between runs looks like a parameter error that drifts. It is estimated beside the effects of a
    hypothesis; for each stretch by the others of its run, so that an estimate explains no row that it was made of.

    Args:
        centre: what is known beside.
        settings: of the gap engine.
    """
    reading, found = centre.reading, []
    effects = undriven(reading.nominal, reading.problem.blocks, settings.effects)
    known = [f for f in centre.fit.simulator.effects if not isinstance(f.effect, ParameterError)]
    simulator = reading.nominal.with_effects(tuple(known))
    for driver in sorted({effect.driver for effect in effects}):
        driven = [effect for effect in effects if effect.driver == driver]
        law = DriverLaw.of(driven, reading.problem, simulator)
        found.append((_with_driver(reading, law, driven), driven))
    return found


def _with_driver(reading: Reading, law: "DriverLaw", driven: Sequence[Effect]) -> Reading:
    prepared, name = reading.prepared, law.name
    problem = prepared.problem
    runs, blocks = len(torch.unique(problem.blocks.run)), len(problem.blocks)
    temper = problem.temper.without(runs / blocks)
    counted = problem.counted.without(runs / blocks) if problem.counted else None
    estimated = replace(
        problem, blocks=with_signal(problem.blocks, name, law.along(problem)), temper=temper, counted=counted
    )
    proving = with_signal(prepared.proving, name, law.along(_problem_on(prepared.proving, problem)))
    remark = (
        f"{name} was not recorded: its changes within each run were estimated from the motion, its absolute value is "
        "unknown; record it to be sure"
    )
    prepared = replace(prepared, problem=estimated, proving=proving, remarks=[*prepared.remarks, remark])
    catalogue = (*reading.catalogue, *driven)
    return Reading(
        reading.held, prepared, catalogue, reading.odds * _UNRECORDED * _share_of_levels(problem), name
    )


def _share_of_levels(problem: Problem) -> float:
    """Return what one free level for each run costs, as odds: (independent rows of the run)^(−½) (Schwarz 1978)."""
    _, blocks = torch.unique(problem.blocks.run, return_counts=True)
    return float((problem.temper.total * blocks.double()).rsqrt().prod())


def undriven(simulator: Simulator, blocks: Blocks, names: Sequence[str] | None) -> list[Effect]:
    """Return the effects that a recording would allow to test if their slow driver had been recorded."""
    recorded = available_signals(blocks.signals)
    wanted = allowed(simulator.platform.kind, names)
    possible = (effect for effect in wanted if recorded.isdisjoint(effect.excluded_by))
    return [effect for effect in possible if set(effect.needs) - recorded == {effect.driver}]


@dataclass(frozen=True)
class DriverLaw:
    """The model of a latent input: a level or a line in time per run, minus a fall with the load.

    Attributes:
        name: of the driver.
        acting: the simulator in which it acts, with default values of the effects that it drives.
        load: the effect that defines its load; None if it has none.
        rest: its value where its effects do nothing, in its unit.
        giving: by how much it falls per load, in its unit; the same in all runs.
    """

    name: str
    acting: Simulator
    load: Effect | None
    rest: float
    giving: float = 0.0

    @classmethod
    def of(cls, effects: Sequence[Effect], problem: Problem, simulator: Simulator) -> "DriverLaw":
        """Fit the law of the driver that some effects share to the runs of a problem.

        Args:
            effects: those that it drives.
            problem: the runs, windows and noise.
            simulator: everything else that is known.
        """
        first = effects[0]
        where = first.driver_at_rest
        rest = float(first.defaults()[where] if where in first.defaults() else simulator.constants()[where])
        acting = simulator.with_effects(
            (*simulator.effects, *(FittedEffect(effect, effect.defaults()) for effect in effects))
        )
        law = cls(first.driver, acting, first, rest)
        load = law._load(problem.blocks)
        return replace(law, load=None) if load is None else replace(law, giving=law._fitted(problem, load))

    def along(self, problem: Problem) -> Tensor:
        """Return the driver along the blocks, (blocks, samples with margins), in its unit.

        Within a run it is a level or a line in time, minus the fall with the load. For each stretch it is fitted by
        least squares to the other stretches of the run, so that no stretch contributes to its own estimate.
        """
        load = self._load(problem.blocks)
        taken = 0.0 if load is None else self.giving * load
        line = constant(problem.blocks, self.rest)
        for _ in range(_DRIVER_PASSES):
            residual, answer = self._answer(problem, line - taken, torch.ones_like(line))
            scale, _ = problem.weigh(residual)
            information = (answer / scale).square().sum((1, 2))
            score = (answer * residual / scale.square()).sum((1, 2))
            shown = problem.blocks.inner(line).mean(1) + score / information.clamp_min(1e-300)
            line = _interpolated(problem, shown, information, self.rest)
        return line - taken

    def _fitted(self, problem: Problem, load: Tensor) -> float:
        """Return by how much the driver falls per load, beside a line in time of each run."""
        series = constant(problem.blocks, self.rest)
        residual, level = self._answer(problem, series, torch.ones_like(series))
        _, falling = self._answer(problem, series, -load)
        weight = (1.0 / problem.weigh(residual)[0]).expand_as(residual)
        time = problem.blocks.start[:, None, None]
        apart = [torch.zeros(()), torch.zeros(())]
        for run in torch.unique(problem.blocks.run):
            mine = problem.blocks.run == run
            columns = [
                level[mine],
                level[mine] * (time[mine] - time[mine].mean()),
                falling[mine],
                residual[mine],
            ]
            line, slope, own, left = ((column * weight[mine]).flatten() for column in columns)
            basis = torch.linalg.qr(torch.stack([line, slope], dim=1))[0]
            own = own - basis @ (basis.T @ own)
            apart = [apart[0] + own @ left, apart[1] + own @ own]
        return max(float(apart[0] / apart[1].clamp_min(1e-300)), 0.0)

    def _answer(self, problem: Problem, series: Tensor, direction: Tensor) -> tuple[Tensor, Tensor]:
        """Return the residual under a driver, and how the prediction answers to a change, (blocks, rows, channels)."""
        step = _DRIVER_STEP * abs(self.rest) / float(direction.abs().max().clamp_min(1e-300))
        residual, moved = (
            replace(problem, blocks=with_signal(problem.blocks, self.name, value)).residual(self.acting)
            for value in (series, series + step * direction)
        )
        return residual, (residual - moved) / step

    def _load(self, blocks: Blocks) -> Tensor | None:
        if self.load is None:
            return None
        resting = with_signal(blocks, self.name, constant(blocks, self.rest))
        signals = self.acting.along_time(resting.signals, blocks.time_step)
        return self.load.load(signals, self.acting.constants())


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


def _problem_on(blocks: Blocks, problem: Problem) -> Problem:
    return replace(problem, blocks=blocks, cluster=independent_clusters(blocks))


def constant(blocks: Blocks, value: float) -> Tensor:
    """Return a series that stays, (blocks, samples with margins)."""
    length = next(iter(blocks.signals.values())).shape[1]
    return torch.full((len(blocks), length), value, dtype=torch.float64)


def with_signal(blocks: Blocks, name: str, series: Tensor) -> Blocks:
    """Return the blocks with one more signal."""
    return replace(blocks, signals={**blocks.signals, name: series})
