"""Whether a recorded command is held until the next sample or was measured at its own, before any physics is asked."""

import torch
from scipy import stats
from torch import Tensor

from pipeline.gap.settings import Gap
from pipeline.physics.weak_form import mean_of, mean_rate_of, window_functions
from pipeline.platforms import Platform
from pipeline.recordings.recording import Recording
from pipeline.simulation.blocks import Blocks, cut_blocks

_CHANCE = 1e-3  # of commands that were held to look measured

_AXES = {"joint": ("velocity", "position"), "swerve": ("steer_velocity", "steer_angle")}
_COMMANDS = {"joint": ("effort", "voltage"), "swerve": ("steer_voltage",), "quadrotor": ("motor_command",)}


def cut_settled_blocks(recording: Recording, platform: Platform, settings: Gap) -> Blocks:
    """Cut a recording with its commands where they act: half a sample matters to friction and inertia.

    A controller holds each command until its next sample; a measured effort or voltage belongs to its own instant, and
    so does the command of a controller that is much faster than the log. Which of the two was recorded shows in how
    well command, velocity, its sign and position together explain the acceleration, whatever the physics; commands are
    taken as held unless the other is clearly better.
    """
    lengths = settings.block_duration, settings.margin
    held = cut_blocks(recording, platform, *lengths)
    if not any(name in held.signals for name in _COMMANDS[recording.kind]):
        return held
    measured = cut_blocks(recording, platform, *lengths, held=False)
    unexplained = _unexplained_rotors if recording.kind == "quadrotor" else _unexplained_axis
    errors = [unexplained(blocks, recording.kind, settings.test_width) for blocks in (held, measured)]
    return measured if _is_less(errors[1], errors[0]) else held


def _is_less(first: Tensor, second: Tensor) -> bool:
    """Return whether errors (blocks,) are less than others beyond chance (one-sided paired t test over blocks)."""
    if len(first) < 2 or torch.equal(first, second):
        return False
    test = stats.ttest_rel(second.numpy(), first.numpy(), alternative="greater")
    return bool(test.pvalue < _CHANCE)


def _unexplained_axis(blocks: Blocks, kind: str, width: float) -> Tensor:
    """Return the mean square of the acceleration that a regression on everything recorded of the axis leaves."""
    functions = window_functions(blocks.samples, width, blocks.time_step)
    signals = {name: blocks.inner(series) for name, series in blocks.signals.items()}
    speed, place = (_per_axis(signals[name]) for name in _AXES[kind])
    commands = [_per_axis(signals[name]) for name in _COMMANDS[kind] if name in signals]
    slow = 0.05 * speed.square().mean().sqrt().clamp_min(1e-12)
    terms = [*commands, speed, torch.tanh(speed / slow), place, torch.sin(place), torch.ones_like(speed)]
    return _left([mean_of(functions, term) for term in terms], mean_rate_of(functions, speed), len(blocks))


def _unexplained_rotors(blocks: Blocks, kind: str, width: float) -> Tensor:
    """Return what the commands leave of the rotors' speeds, or of the turning where no speed is recorded."""
    functions = window_functions(blocks.samples, width, blocks.time_step)
    command = blocks.inner(blocks.signals["motor_command"])
    if "rotor_speed" in blocks.signals:
        speed = _per_axis(blocks.inner(blocks.signals["rotor_speed"]))
        terms = [_per_axis(command), torch.ones_like(speed)]
        return _left([mean_of(functions, term) for term in terms], mean_of(functions, speed), len(blocks))
    rate = blocks.inner(blocks.signals["body_rate"])
    squares = [mean_of(functions, command[..., rotor] ** 2) for rotor in range(command.shape[-1])]
    turning = [mean_rate_of(functions, rate[..., axis]) for axis in range(2)]
    scale = [axis.square().mean().clamp_min(1e-24) for axis in turning]
    left = [_left(squares, axis, len(blocks)) / size for axis, size in zip(turning, scale, strict=True)]
    return torch.stack(left).sum(0)


def _left(terms: list[Tensor], target: Tensor, blocks: int) -> Tensor:
    """Return the mean square that a regression on the terms leaves of a target in each block, (blocks,)."""
    matrix = torch.stack([term.flatten() for term in terms], dim=1)
    goal = target.flatten()
    weights = torch.linalg.lstsq(matrix, goal[:, None]).solution[:, 0]
    return (goal - matrix @ weights).square().reshape(blocks, -1).mean(1)


def _per_axis(series: Tensor) -> Tensor:
    """Return (blocks · axes, samples): the modules of a swerve drive one below the other."""
    return series if series.ndim == 2 else series.transpose(1, 2).flatten(0, 1)
