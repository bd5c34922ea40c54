"""The parts of a diagnosis that tests of one part need from the others."""

import functools
from collections.abc import Sequence

import torch

from simgap.diagnosis.diagnose import Diagnosis, diagnose
from simgap.effects import Effect, effect_by_key
from simgap.equations.problem import Problem
from simgap.equations.residuals import quadrature_of_rows
from simgap.equations.row_noise import noise_of_rows
from simgap.equations.scoring import independent_clusters
from simgap.equations.temper import temper_of
from simgap.gap.settings import Gap
from simgap.physics.weak_form import window_functions
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.blocks import Blocks, cut_blocks
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

FEW = (
    "coulomb_friction",
    "viscous_friction",
    "current_limit",
    "command_delay",
    "inertia_error",
    "motor_constant_error",
)
"""What the test's own joint may have: enough where nothing is said of the rest, in a fifth of the catalogue's time."""


def blocks_of(recording: Recording, simulator: Simulator, settings: Gap | None = None) -> Blocks:
    settings = settings or Gap()
    return cut_blocks(recording, simulator.platform, settings.block_duration, settings.margin)


def problem_of(recording: Recording, simulator: Simulator) -> Problem:
    """Return what a fit works on, with every run in it."""
    blocks = blocks_of(recording, simulator)
    functions = window_functions(blocks.samples, Gap().test_width, blocks.time_step)
    noise, quadrature = (of(simulator, blocks, functions) for of in (noise_of_rows, quadrature_of_rows))
    temper = temper_of(blocks, functions, Gap().test_width)
    return Problem(blocks, functions, noise, quadrature, independent_clusters(blocks), temper)


def at_start(effect: Effect) -> FittedEffect:
    """Return an effect that does nothing yet."""
    return FittedEffect(effect, effect.neutral())


def of_joint(*names: str) -> tuple[Effect, ...]:
    return tuple(effect_by_key("joint", name) for name in names)


def quick(recording: Recording, simulator: Simulator, effects: Sequence[str] | None = None) -> Diagnosis:
    """Diagnose with few resamples and a short horizon, on which no name or number depends."""
    settings = Gap(resamples=50, horizon=0.05, effects=None if effects is None else list(effects))
    return diagnose(recording, simulator, settings)


@functools.cache
def diagnosed(
    plant: Plant, seed: int = 0, runs: int = 6, effects: tuple[str, ...] | None = None
) -> Diagnosis:
    """Diagnose a recording of the test's own joint, once per session."""
    return quick(joint_recording(plant, seed, runs), joint_simulator(), effects)


def named(diagnosis: Diagnosis) -> list[str]:
    """Return the named effects, most probable first."""
    order = sorted(diagnosis.probabilities, key=lambda key: -diagnosis.probabilities[key])
    assert set(order) == {candidate.effect.key for candidate in diagnosis.naming.named}
    return order


def value_of(diagnosis: Diagnosis, key: str) -> float:
    """Return the first parameter of a named effect, its strength."""
    (fitted,) = (f for f in diagnosis.simulator.effects if f.effect.key == key)
    value = next(iter(fitted.values.values()))
    return value


def random_like(shape: tuple[int, ...], seed: int) -> torch.Tensor:
    return torch.randn(shape, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)
