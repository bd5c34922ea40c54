"""Zero-order hold or measured command: a test that needs no named effects."""

import torch
from scipy import stats
from torch import Tensor

from simgap.gap.settings import Gap
from simgap.physics.weak_form import mean_of, mean_rate_of, window_functions
from simgap.platforms import Platform
from simgap.recordings.recording import Recording
from simgap.simulation.blocks import Blocks, cut_blocks

_MEASURED_LEVEL = 1e-3  # level of the test

_AXIS_SIGNALS = {"joint": ("velocity", "position"), "swerve": ("steer_velocity", "steer_angle")}
_COMMANDS = {"joint": ("effort", "voltage"), "swerve": ("steer_voltage",)}
HELD_KINDS = frozenset(_AXIS_SIGNALS)
"""Kinds of machine whose controllers are about as fast as their logs."""


def cut_blocks_as_held(
    recording: Recording, platform: Platform, settings: Gap, held: bool | None = None
) -> Blocks:
    """Cut a recording into blocks with the right timing of its commands; half a sample matters to friction and inertia.

    The controller of a joint or a drive holds each command until its next sample; a measured effort or voltage
    belongs to its own instant. The acceleration is regressed on command, velocity, its sign and position under both
    readings. Commands count as held unless the other reading is significantly better. The controller of a multirotor
    is usually much faster than its log, so its commands count as measured (see also `simgap.gap.command_hold`).

    Args:
        recording: cleaned.
        platform: whose signals are read.
        settings: of the gap engine.
        held: whether commands are held between samples; None: what the recording looks like.
    """
    lengths = settings.block_duration, settings.margin
    if held is not None or recording.kind not in HELD_KINDS:
        return cut_blocks(recording, platform, *lengths, held=bool(held))
    steady, measured = (cut_blocks(recording, platform, *lengths, held=each) for each in (True, False))
    errors = [_unexplained(blocks, recording.kind, settings.test_width) for blocks in (steady, measured)]
    return measured if _is_less(errors[1], errors[0]) else steady


def _is_less(first: Tensor, second: Tensor) -> bool:
    """Return whether errors (blocks,) are less than others beyond chance (one-sided paired t test over blocks)."""
    if len(first) < 2 or torch.equal(first, second):
        return False
    test = stats.ttest_rel(second.numpy(), first.numpy(), alternative="greater")
    return bool(test.pvalue < _MEASURED_LEVEL)


def _unexplained(blocks: Blocks, kind: str, width: float) -> Tensor:
    """Return the mean square of the acceleration that a regression on everything recorded of the axis leaves."""
    functions = window_functions(blocks.samples, width, blocks.time_step)
    signals = {name: blocks.acting_inside(series) for name, series in blocks.acting.items()}
    speed, place = (_per_axis(signals[name]) for name in _AXIS_SIGNALS[kind])
    commands = [_per_axis(signals[name]) for name in _COMMANDS[kind] if name in signals]
    slow = 0.05 * speed.square().mean().sqrt().clamp_min(1e-12)
    terms = [*commands, speed, torch.tanh(speed / slow), place, torch.sin(place), torch.ones_like(speed)]
    recorded = _per_axis(blocks.inner(blocks.signals[_AXIS_SIGNALS[kind][0]]))
    rate = mean_rate_of(functions, recorded, blocks.held)
    means = [mean_of(functions, blocks.at_samples(term)) for term in terms]
    return _unexplained_mean_square(means, rate, len(blocks))


def _unexplained_mean_square(terms: list[Tensor], target: Tensor, blocks: int) -> Tensor:
    """Return the mean square that a regression on the terms leaves of a target in each block, (blocks,)."""
    matrix = torch.stack([term.flatten() for term in terms], dim=1)
    goal = target.flatten()
    weights = torch.linalg.lstsq(matrix, goal[:, None]).solution[:, 0]
    return (goal - matrix @ weights).square().reshape(blocks, -1).mean(1)


def _per_axis(series: Tensor) -> Tensor:
    """Return (blocks · axes, samples): the modules of a swerve drive one below the other."""
    return series if series.ndim == 2 else series.transpose(1, 2).flatten(0, 1)
