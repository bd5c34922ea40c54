"""Latent inputs: unrecorded slow drivers (battery voltage, motor temperature), estimated from the motion."""

from collections.abc import Sequence
from dataclasses import replace

import torch

from simgap.effects import Effect, ParameterError
from simgap.equations.problem import Problem
from simgap.equations.scoring import independent_clusters
from simgap.gap.candidates import allowed, available_signals
from simgap.gap.driver_law import DriverLaw, with_signal
from simgap.gap.hypothesis import Hypothesis
from simgap.gap.reading import Reading
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.blocks import Blocks

_UNRECORDED = 0.1
"""Odds that a driver which nobody recorded changed enough to be seen: who expects that records it."""


def driven_readings(centre: Hypothesis, settings: Gap) -> list[tuple[Reading, Effect]]:
    """Return readings in which a driver that was not recorded is estimated, each with the effect that it drives.

    A driver that changes between runs looks like a parameter error that drifts. It is estimated beside the effects of a
    hypothesis; for each stretch by the others of its run, so that an estimate explains no row that it was made of. Of
    the effects that one driver has, each is taken to act alone: drive motors may follow a battery that the steering
    motors' controllers compensate for.

    Args:
        centre: what is known beside.
        settings: of the gap engine.
    """
    reading, found = centre.reading, []
    effects = undriven(reading.nominal, reading.problem.blocks, settings.effects)
    known = [f for f in centre.fit.simulator.effects if not isinstance(f.effect, ParameterError)]
    simulator = reading.nominal.with_effects(tuple(known))
    for effect in effects:
        law = DriverLaw.of([FittedEffect(effect, effect.defaults())], reading.problem, simulator)
        alike = [other for other in effects if other.driver == effect.driver]
        found.append((_with_driver(reading, law, alike), effect))
    return found


def driven_again(found: Hypothesis, before: Reading) -> Reading:
    """Return a reading with the driver of a hypothesis estimated once more, by the values that were found with it.

    Args:
        found: the hypothesis.
        before: the reading without the driver.
    """
    driver = found.reading.driver
    simulator = found.fit.simulator
    acting = [f for f in simulator.effects if f.effect.driver == driver]
    others = simulator.with_effects(tuple(f for f in simulator.effects if f.effect.driver != driver))
    alike = [effect for effect in found.reading.catalogue if effect.driver == driver]
    return _with_driver(before, DriverLaw.of(acting, before.problem, others), alike)


def _with_driver(reading: Reading, law: DriverLaw, driven: Sequence[Effect]) -> Reading:
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


def _problem_on(blocks: Blocks, problem: Problem) -> Problem:
    return replace(problem, blocks=blocks, cluster=independent_clusters(blocks))
