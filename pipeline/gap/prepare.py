"""Preparation of a recording: blocks, fitted and held-out runs, noise floor, resolution."""

from dataclasses import dataclass, replace

import torch

from simgap.effects.sizes import sizes_of
from simgap.equations.problem import Problem
from simgap.equations.residuals import quadrature_of_rows
from simgap.equations.resolution import resolution_of, resolved, with_resolution
from simgap.equations.row_noise import noise_of_rows
from simgap.equations.scoring import ENOUGH_CLUSTERS, independent_clusters
from simgap.equations.sensors import settle_accelerometer, settle_velocity
from simgap.equations.temper import temper_of
from simgap.equations.width import width_of
from simgap.errors import InputError
from simgap.gap.settings import Gap
from simgap.physics.weak_form import window_functions
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks, cut_blocks

_SHORTEST = 0.5  # s, shortest block
_COMMANDED = ("joint", "quadrotor")
"""Kinds whose rows are put on the side of the commands. A wheel that rests holds noise that no command explains."""
_AXES = ("joint",)
"""Kinds whose commands and motion are two sides of one effort, either of which may be small."""
_LONGEST_STEP = 1.0  # s between samples; slower recordings do not show the motion


@dataclass(frozen=True)
class Prepared:
    """The prepared data of a diagnosis.

    Attributes:
        nominal: the simulator before, with the resolution of the recording.
        width: of the windows, s.
        problem: the fitted runs.
        proving: the runs for validation.
        held_out: whether those were kept from the fit.
        remarks: corrections of the sensors, a sentence each.
    """

    nominal: Simulator
    width: float
    problem: Problem
    proving: Blocks
    held_out: bool
    remarks: list[str]

    @property
    def recorded(self) -> tuple[Blocks, Blocks]:
        """All blocks: the fitted ones and those for validation."""
        return self.problem.blocks, self.proving


def prepare(recording: Recording, nominal: Simulator, settings: Gap, held: bool) -> Prepared:
    """Cut a recording and divide it.

    Args:
        recording: cleaned, with its runs divided into train, validation and hold-out.
        nominal: what is believed before.
        settings: of the gap engine.
        held: whether commands are held between samples.

    Raises:
        InputError: when the recording is too short or its samples too rare, or no run is left to fit.
    """
    _require_motion(recording)
    blocks = _cut(recording, nominal, settings, held)
    width = width_of(nominal, _fitted(blocks, recording.split, settings), settings.test_width)
    blocks, remarks = _settled(blocks, recording, nominal, width)
    fitted, proving, held_out = _divide(blocks, recording.split, settings)
    nominal, known_to = resolved(nominal, fitted), resolution_of(nominal, fitted)
    fitted, proving = (with_resolution(blocks, nominal, known_to) for blocks in (fitted, proving))
    functions = window_functions(fitted.samples, width, fitted.time_step)
    noise, quadrature = (of(nominal, fitted, functions) for of in (noise_of_rows, quadrature_of_rows))
    sizes = sizes_of(recording.kind, fitted.signals, nominal.constants())
    temper = temper_of(fitted, functions, width)
    problem = Problem(
        fitted,
        functions,
        noise,
        quadrature,
        independent_clusters(fitted),
        temper,
        sizes,
        nominal=nominal if recording.kind in _COMMANDED else None,
        is_axis=recording.kind in _AXES,
    )
    return Prepared(nominal, width, problem, proving, held_out, remarks)


def _require_motion(recording: Recording) -> None:
    if recording.time_step > _LONGEST_STEP:
        raise InputError(
            f"one sample every {recording.time_step:.3g} s is too slow: is t in milliseconds instead of seconds?",
            recording.source or "recording",
            "give the time t in seconds",
        )


def _cut(recording: Recording, nominal: Simulator, settings: Gap, held: bool) -> Blocks:
    settings = _suiting(settings, recording)
    return cut_blocks(recording, nominal.platform, settings.block_duration, settings.margin, held=held)


def _settled(
    blocks: Blocks, recording: Recording, nominal: Simulator, width: float
) -> tuple[Blocks, list[str]]:
    remarks: list[str] = []
    if recording.kind == "quadrotor":
        blocks, remarks = settle_accelerometer(blocks, nominal.platform.gravity, width)
    if recording.kind == "joint":
        blocks, remarks = settle_velocity(blocks, width)
    return _with_clock_deviation(blocks, recording.clock_offset), remarks


def _suiting(settings: Gap, recording: Recording) -> Gap:
    """Return settings with blocks short enough that a short recording gives enough clusters."""
    fitted = sum(recording.split.get(run, "train") != "holdout" for run in recording.frame["run"])
    enough = fitted * recording.time_step / ENOUGH_CLUSTERS
    return replace(settings, block_duration=min(settings.block_duration, max(enough, _SHORTEST)))


def _with_clock_deviation(blocks: Blocks, offsets: dict[str, float]) -> Blocks:
    """Add the deviation of each run's clock offset from the mean of the estimated ones."""
    known = [offsets[run] for run in blocks.runs if run in offsets]
    if not known:
        return blocks
    mean = sum(known) / len(known)
    deviation = torch.tensor([offsets.get(run, mean) - mean for run in blocks.runs], dtype=torch.float64)
    length = next(iter(blocks.signals.values())).shape[1]
    series = deviation[blocks.run][:, None].expand(-1, length)
    return replace(blocks, signals={**blocks.signals, "clock_deviation": series})


def _fitted(blocks: Blocks, split: dict[str, str], settings: Gap) -> Blocks:
    """Return the blocks to fit."""
    fitted = blocks.of_runs([run for run in blocks.runs if split.get(run, "train") != "holdout"])
    if not len(fitted):
        raise InputError("no run is left to fit", "dataset.split", "hold out fewer runs")
    return fitted.thinned(settings.most_blocks)


def _divide(blocks: Blocks, split: dict[str, str], settings: Gap) -> tuple[Blocks, Blocks, bool]:
    """Return the blocks to fit, those to prove on, and whether the latter are held out."""
    fitted = _fitted(blocks, split, settings)
    proving = blocks.of_runs([run for run in blocks.runs if split.get(run) == "holdout"])
    return (fitted, proving.thinned(settings.most_blocks), True) if len(proving) else (fitted, fitted, False)
