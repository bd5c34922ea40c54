"""How the inputs of a recording act: commands held or measured, slow drivers recorded or estimated.

Commands may be held from one sample to the next, or measured at their own instants. A battery's voltage that nobody
recorded may follow from the motion. Which of these is right shows only together with the effects, so that the reading
of a recording is one half of a hypothesis and its effects are the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import torch

from simgap.effects import Effect
from simgap.equations.fit import fit
from simgap.equations.noise_ceiling import noise_ceiling
from simgap.equations.presence import Presence
from simgap.equations.problem import Problem
from simgap.equations.starts import Starts
from simgap.equations.temper import WIDTHS
from simgap.equations.trend import Trend
from simgap.gap.candidates import candidates_for
from simgap.gap.likelihood import LikelihoodOf, counted_beside
from simgap.gap.prepare import Prepared, prepare
from simgap.gap.scales import Scales, scales_of
from simgap.gap.settings import Gap
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.signals import COMMANDS

Timing = tuple[bool, str, Presence | Trend | None]
"""Whether commands are held, which driver was estimated, and which effects act in a part of the recording or drift."""

_FAST_CONTROLLER = 0.3
"""Odds that a multirotor's commands are held as long as its samples last: most controllers are faster than logs."""


@dataclass(frozen=True)
class Reading:
    """A recording with one timing of its commands, and with or without an estimated driver.

    Attributes:
        held: whether commands are held between samples.
        prepared: the rows.
        catalogue: effects that may be missing.
        odds: prior odds of this reading.
        driver: the signal that was estimated from the motion; empty where none was.
        presence: of effects that act in a part of the recording, or grow or fade; None: all effects act throughout.
        throughout: the same reading in which all effects act throughout, where some do not in this one.
    """

    held: bool
    prepared: Prepared
    catalogue: tuple[Effect, ...]
    odds: float = 1.0
    driver: str = ""
    presence: Presence | Trend | None = None
    throughout: "Reading | None" = None

    @property
    def timing(self) -> Timing:
        """What tells it from other readings."""
        return self.held, self.driver, self.presence

    @property
    def nominal(self) -> Simulator:
        """What is believed before, with the resolution of the recording."""
        return self.prepared.nominal

    @property
    def problem(self) -> Problem:
        """What is fitted."""
        return self.prepared.problem

    def known(self, effect: Effect) -> FittedEffect | None:
        """Return what is known of an effect before, if anything is."""
        return next((f for f in self.nominal.known if f.effect.key == effect.key), None)

    @cached_property
    def scales(self) -> Scales:
        """Typical sizes of what was recorded."""
        return scales_of(self.nominal, self.problem)

    @cached_property
    def starts(self) -> Starts:
        """Where fits of the effects begin."""
        return Starts(self.nominal, self.problem, self.throughout.starts if self.throughout else None)

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

    Raises:
        InputError: when the recording is too short or its samples too rare, or no run is left to fit.
    """
    measured = _reading(recording, nominal, settings, held=False)
    if COMMANDS.isdisjoint(measured.problem.blocks.signals):
        return _alike([measured])
    return _alike([measured, _reading(recording, nominal, settings, held=True)])


def likeliest_reading(recording: Recording, simulator: Simulator, settings: Gap) -> Reading:
    """Return the reading under which a simulator explains a recording best.

    Args:
        recording: cleaned.
        simulator: with all that is known.
        settings: of the gap engine.
    """
    readings = readings_of(recording, simulator, settings)
    return max(readings, key=lambda each: each.likelihood_of(fit(each.nominal, each.problem)).value)


def _reading(recording: Recording, nominal: Simulator, settings: Gap, held: bool) -> Reading:
    prepared = prepare(recording, nominal, settings, held)
    odds = _FAST_CONTROLLER if held and recording.kind == "quadrotor" else 1.0
    blocks = prepared.problem.blocks
    catalogue = candidates_for(prepared.nominal, blocks.signals, settings.effects)
    # Of less than that there is not one independent sample of what any law leaves: nothing can be told from it.
    enough = len(blocks) * blocks.samples * blocks.time_step >= WIDTHS * prepared.width
    return Reading(held, prepared, tuple(catalogue) if enough else (), odds)


def _alike(readings: Sequence[Reading]) -> list[Reading]:
    """Return readings whose rows have the same noise and count the same: the sensors' noise, however commands act.

    It is at most what all linear laws leave under any of the readings.
    """
    ceilings = [noise_ceiling(each.nominal, each.problem, _laws(each)) for each in readings]
    noises = [each.problem.noise for each in readings]
    pairs = zip(ceilings, noises, strict=True)
    shares = [torch.where(noise > ceiling, ceiling / noise, 1.0) for ceiling, noise in pairs]
    share = torch.stack(shares).amin(0)
    quiet = [replace(each.problem, noise=share * each.problem.noise) for each in readings]
    counted = counted_beside(quiet[0], quiet[0].residual(readings[0].nominal))
    return [
        replace(each, prepared=replace(each.prepared, problem=replace(problem, counted=counted)))
        for each, problem in zip(readings, quiet, strict=True)
    ]


def _laws(reading: Reading) -> list[Effect]:
    """Return all effects that the recording allows to test, whichever may be named: noise does not depend on that."""
    return candidates_for(reading.nominal, reading.problem.blocks.signals, None)
