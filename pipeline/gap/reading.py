"""How the commands of a recording act: held from one sample to the next, or measured at their own instants.

Which of the two is right shows only together with the effects, so that each is half of a hypothesis.
"""

from dataclasses import dataclass, replace
from functools import cached_property

from simgap.effects import Effect
from simgap.gap.candidates import candidates_for
from simgap.gap.fit import Problem
from simgap.gap.likelihood import LikelihoodOf
from simgap.gap.prepare import Prepared, prepare
from simgap.gap.scales import Scales, scales_of
from simgap.gap.settings import Gap
from simgap.gap.temper import temper_of
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.signals import COMMANDS

_FAST_CONTROLLER = 0.1
"""Odds that a multirotor's commands are held as long as its samples last: most controllers are faster than their logs."""


@dataclass(frozen=True)
class Reading:
    """A recording under one timing of its commands.

    Attributes:
        held: whether commands are held between samples.
        prepared: the rows.
        catalogue: effects that may be missing.
        odds: prior odds of this timing.
    """

    held: bool
    prepared: Prepared
    catalogue: tuple[Effect, ...]
    odds: float = 1.0

    @property
    def nominal(self) -> Simulator:
        """What is believed before, with the resolution of the recording."""
        return self.prepared.nominal

    @property
    def problem(self) -> Problem:
        """What is fitted."""
        return self.prepared.problem

    @cached_property
    def scales(self) -> Scales:
        """Typical sizes of what was recorded."""
        return scales_of(self.nominal, self.problem.blocks)

    @cached_property
    def likelihood_of(self) -> LikelihoodOf:
        """The likelihood of fits to these rows."""
        return LikelihoodOf(self.problem, self.nominal)


def readings_of(recording: Recording, nominal: Simulator, settings: Gap) -> list[Reading]:
    """Return the readings that a recording allows.

    Args:
        recording: cleaned.
        nominal: what is believed before.
        settings: of the gap engine.
    """
    measured = _reading(recording, nominal, settings, held=False)
    if COMMANDS.isdisjoint(measured.problem.blocks.signals):
        return [measured]
    return [measured, _reading(recording, nominal, settings, held=True)]


def _reading(recording: Recording, nominal: Simulator, settings: Gap, held: bool) -> Reading:
    prepared = prepare(recording, nominal, settings, held)
    problem = prepared.problem
    problem = replace(problem, temper=temper_of(problem.blocks, problem.functions))
    prepared = replace(prepared, problem=problem)
    signals = prepared.problem.blocks.signals
    odds = _FAST_CONTROLLER if held and recording.kind == "quadrotor" else 1.0
    return Reading(held, prepared, tuple(candidates_for(prepared.nominal, signals, settings.effects)), odds)
