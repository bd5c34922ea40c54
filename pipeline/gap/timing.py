"""Whether a recorded command is held until the next sample or was measured at its own, before any physics is asked."""

import torch
from torch import Tensor

from pipeline.gap.settings import Gap
from pipeline.physics.weak_form import mean_of, mean_rate_of, window_functions
from pipeline.platforms import Platform
from pipeline.recordings.recording import Recording
from pipeline.simulation.blocks import Blocks, cut_blocks

_CLEARLY = 0.5  # of the error of held commands: no more may be left for them to have been measured instead

_AXES = {"joint": ("velocity", "position"), "swerve": ("steer_velocity", "steer_angle")}
_COMMANDS = {"joint": ("effort", "voltage"), "swerve": ("steer_voltage",)}


def cut_settled_blocks(recording: Recording, platform: Platform, settings: Gap) -> Blocks:
    """Cut a recording with its commands where they act: half a sample matters to friction and inertia.

    A controller holds each command until its next sample; a measured effort or voltage belongs to its own instant.
    Which of the two was recorded shows in how well command, velocity, its sign and position together explain the
    acceleration, whatever the physics; commands are taken as held unless the other is clearly better.
    """
    lengths = settings.block_duration, settings.margin
    held = cut_blocks(recording, platform, *lengths)
    if recording.kind not in _AXES:
        return held
    measured = cut_blocks(recording, platform, *lengths, held=False)
    errors = [_unexplained(blocks, recording.kind, settings.test_width) for blocks in (held, measured)]
    return measured if errors[1] < _CLEARLY * errors[0] else held


def _unexplained(blocks: Blocks, kind: str, width: float) -> float:
    """Return the mean square of the acceleration that a regression on everything recorded of the axis leaves."""
    functions = window_functions(blocks.samples, width, blocks.time_step)
    signals = {name: blocks.inner(series) for name, series in blocks.signals.items()}
    speed, place = (_per_axis(signals[name]) for name in _AXES[kind])
    commands = [_per_axis(signals[name]) for name in _COMMANDS[kind] if name in signals]
    slow = 0.05 * speed.square().mean().sqrt().clamp_min(1e-12)
    terms = [*commands, speed, torch.tanh(speed / slow), place, torch.sin(place), torch.ones_like(speed)]
    matrix = torch.stack([mean_of(functions, term).flatten() for term in terms], dim=1)
    target = mean_rate_of(functions, speed).flatten()
    weights = torch.linalg.lstsq(matrix, target[:, None]).solution[:, 0]
    return float((target - matrix @ weights).square().mean())


def _per_axis(series: Tensor) -> Tensor:
    """Return (blocks · axes, samples): the modules of a swerve drive one below the other."""
    return series if series.ndim == 2 else series.transpose(1, 2).flatten(0, 1)
