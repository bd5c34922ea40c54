"""From a recording to what is fitted and what is held out: blocks, windows, noise, and how finely they resolve."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from pipeline.errors import InputError
from pipeline.gap.fit import Problem
from pipeline.gap.residuals import noise_of_rows, quadrature_of_rows
from pipeline.gap.scoring import clusters_of
from pipeline.gap.sensors import settle_accelerometer, settle_velocity
from pipeline.gap.settings import Gap
from pipeline.gap.timing import cut_settled_blocks
from pipeline.physics.weak_form import window_functions
from pipeline.recordings.recording import Recording
from pipeline.simulation import Simulator
from pipeline.simulation.blocks import Blocks

CLUSTER_DURATION = 3.0  # s; residuals further apart than this count as independent
_LEAST_CHANGES = (
    0.05  # of the changes of a velocity from sample to sample are no larger than one step of its sensor
)
_CROSSED = 0.5  # of the change over a step through which the mean velocity is taken: zero is passed within it
_MOST_CHANGES = 10_000_000  # that a quantile is taken of


@dataclass(frozen=True)
class Prepared:
    """What a diagnosis works on.

    Attributes:
        nominal: the simulator before, with the resolution of the recording.
        problem: the runs to fit.
        proving: the runs to prove on.
        held_out: whether those were kept from the fit.
        remarks: what was settled about the sensors on the way.
    """

    nominal: Simulator
    problem: Problem
    proving: Blocks
    held_out: bool
    remarks: list[str]


def prepare(recording: Recording, nominal: Simulator, settings: Gap, held: bool | None = None) -> Prepared:
    """Cut a recording and divide it.

    Args:
        recording: cleaned, with its runs divided into train, validation and hold-out.
        nominal: what is believed before.
        settings: of the gap engine.
        held: whether commands are held between samples; None: what the recording looks like.

    Raises:
        InputError: when the recording is too short, or no run is left to fit.
    """
    blocks, remarks = _blocks(recording, nominal, settings, held)
    fitted, proving, held_out = _divide(blocks, recording.split, settings)
    nominal = _resolved(nominal, fitted)
    functions = window_functions(fitted.samples, settings.test_width, fitted.time_step)
    noise, quadrature = (of(nominal, fitted, functions) for of in (noise_of_rows, quadrature_of_rows))
    problem = Problem(fitted, functions, noise, quadrature, clusters_of(fitted, CLUSTER_DURATION))
    return Prepared(nominal, problem, proving, held_out, remarks)


def _blocks(
    recording: Recording, nominal: Simulator, settings: Gap, held: bool | None
) -> tuple[Blocks, list[str]]:
    blocks = cut_settled_blocks(recording, nominal.platform, settings, held)
    remarks: list[str] = []
    if recording.kind == "quadrotor":
        blocks, remarks = settle_accelerometer(blocks, nominal.platform.gravity, settings.test_width)
    if recording.kind == "joint":
        blocks, remarks = settle_velocity(blocks, settings.test_width)
    return _with_clock_deviation(blocks, recording.clock_offset), remarks


def _with_clock_deviation(blocks: Blocks, offsets: dict[str, float]) -> Blocks:
    """Add how much each run's clock offset differs from the mean of those that cleaning could tell."""
    known = [offsets[run] for run in blocks.runs if run in offsets]
    if not known:
        return blocks
    mean = sum(known) / len(known)
    deviation = torch.tensor([offsets.get(run, mean) - mean for run in blocks.runs], dtype=torch.float64)
    length = next(iter(blocks.signals.values())).shape[1]
    series = deviation[blocks.run][:, None].expand(-1, length)
    return replace(blocks, signals={**blocks.signals, "clock_deviation": series})


def _divide(blocks: Blocks, split: dict[str, str], settings: Gap) -> tuple[Blocks, Blocks, bool]:
    """Return the blocks to fit, those to prove on, and whether the latter are held out."""
    kept = [run for run in blocks.runs if split.get(run, "train") != "holdout"]
    held = [run for run in blocks.runs if split.get(run) == "holdout"]
    fitted, proving = blocks.of_runs(kept), blocks.of_runs(held)
    if not len(fitted):
        raise InputError("no run is left to fit", "dataset.split", "hold out fewer runs")
    fitted = fitted.thinned(settings.most_blocks)
    return (fitted, proving.thinned(settings.most_blocks), True) if len(proving) else (fitted, fitted, False)


def _resolved(nominal: Simulator, blocks: Blocks) -> Simulator:
    """Set the speeds below which the recording cannot tell the direction of motion."""
    found = {
        name: _resolution(blocks.inner(velocity), blocks.on_steps)
        for name, velocity in _sliding_velocities(nominal, blocks.signals).items()
    }
    return replace(nominal, settings={**found, **nominal.settings})


def _sliding_velocities(nominal: Simulator, signals: dict[str, Tensor]) -> dict[str, Tensor]:
    """Return what slides by the name of the setting that says when it does."""
    if nominal.platform.kind == "joint":
        return {"sliding_velocity": signals["velocity"]}
    if nominal.platform.kind == "swerve":
        return {
            "drive_sliding_velocity": signals["drive_velocity"] / nominal.constants()["drive_gear_ratio"],
            "steer_sliding_velocity": signals["steer_velocity"],
        }
    return {}


def _resolution(velocity: Tensor, on_steps: bool) -> float:
    """Return the speed below which a recorded velocity (blocks, samples, ...) leaves its sign open."""
    usual, changes = float(velocity.square().mean().sqrt()), velocity.diff(dim=1).abs()
    jitter = float(changes.square().median().sqrt()) * (_CROSSED if on_steps else 1.0)
    moved = changes[changes > 1e-9 * max(usual, 1e-12)]
    quantum = float(moved.quantile(_LEAST_CHANGES)) if 0 < len(moved) < _MOST_CHANGES else 0.0
    return max(0.01 * usual, jitter, quantum, 1e-6)
