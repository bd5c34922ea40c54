"""Errors of open-loop predictions before and after, and the error that sensor noise alone would cause."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from simgap.equations.sample_noise import sample_noise
from simgap.physics.rotations import rotation_angle
from simgap.simulation import Simulator, replay
from simgap.simulation.blocks import Blocks
from simgap.simulation.motion import motion_of
from simgap.simulation.replay import substeps_for

_UNITS = {
    "position": "m",
    "velocity": "m/s",
    "attitude": "rad",
    "body_rate": "rad/s",
    "chassis_velocity": "m/s and rad/s",
    "steer_angle": "rad",
    "heading": "rad",
    "steer_velocity": "rad/s",
}
_STEPS_SHOWN = 25
_PERCENTILES = (2.5, 97.5)


@dataclass(frozen=True)
class HorizonError:
    """Mean error of one part of the state against the length of the prediction.

    Attributes:
        quantity: part of the state; an attitude's error is the angle, any other's the Euclidean norm.
        unit: its unit.
        horizon: s, (steps,).
        before: mean error with 95 % interval over runs: (steps, 3) mean, low, high; one run has no interval: NaN.
        after: the same with the named effects.
        noise_floor: error that sensor noise alone would give a right simulator, (steps,).
    """

    quantity: str
    unit: str
    horizon: Tensor
    before: Tensor
    after: Tensor
    noise_floor: Tensor


def horizon_errors(
    nominal: Simulator, augmented: Simulator, blocks: Blocks, horizon: float, resamples: int
) -> list[HorizonError]:
    """Predict from the first sample of every block with the recorded commands and compare with the recording."""
    steps = min(round(horizon / blocks.time_step), blocks.samples - 1)
    motion = motion_of(nominal.platform, blocks.signals)
    signals = {name: blocks.inner(series)[:, : steps + 1] for name, series in blocks.signals.items()}
    recorded = motion.pack(signals)
    noise = state_noise(blocks, nominal)
    finest = max(substeps_for(simulator, blocks, steps, noise) for simulator in (nominal, augmented))
    before = replay(nominal, blocks, recorded[:, 0], steps, finest)
    random = torch.Generator().manual_seed(0)
    shaken = motion.normalise(_shaken(recorded[:, 0], noise, random))
    # Twice as many blocks at once take hardly longer than once.
    twice = blocks.take(torch.arange(len(blocks)).repeat(2))
    both = replay(augmented, twice, torch.cat([recorded[:, 0], shaken]), steps, finest)
    after, perturbed = both.chunk(2)
    ends = _shaken(perturbed, noise, random)
    shown = torch.unique(torch.linspace(1, steps, min(steps, _STEPS_SHOWN)).round().long())
    errors = []
    for quantity, where in motion.parts.items():
        pairs = ((before, recorded), (after, recorded), (motion.normalise(ends), after))
        sizes = [_size(quantity, a[..., where], b[..., where])[:, shown] for a, b in pairs]
        sizes = [torch.nan_to_num(size, nan=1e9, posinf=1e9).clamp_max(1e9) for size in sizes]
        errors.append(
            HorizonError(
                quantity,
                nominal.position_unit if _is_joint_position(nominal, quantity) else _unit(nominal, quantity),
                shown * blocks.time_step,
                _with_interval(sizes[0], blocks.run, resamples),
                _with_interval(sizes[1], blocks.run, resamples),
                sizes[2].mean(0),
            )
        )
    return errors


def _is_joint_position(simulator: Simulator, quantity: str) -> bool:
    return simulator.platform.kind == "joint" and quantity == "position"


def _unit(simulator: Simulator, quantity: str) -> str:
    if simulator.platform.kind == "joint":
        return f"{simulator.position_unit}/s"
    return _UNITS[quantity]


def state_noise(blocks: Blocks, simulator: Simulator) -> Tensor:
    """Return the standard deviation of the sensor noise on each component of the state, (n,)."""
    motion = motion_of(simulator.platform, blocks.signals)
    state = motion.pack({name: blocks.inner(series) for name, series in blocks.signals.items()})
    return torch.stack(
        [sample_noise(state[..., i], blocks.noise_kept).sqrt() for i in range(state.shape[-1])]
    )


def _shaken(state: Tensor, noise: Tensor, random: torch.Generator) -> Tensor:
    return state + noise * torch.randn(state.shape, generator=random, dtype=state.dtype)


def _size(quantity: str, simulated: Tensor, recorded: Tensor) -> Tensor:
    if quantity == "attitude":
        return rotation_angle(simulated, recorded)
    return (simulated - recorded).norm(dim=-1)


def _with_interval(sizes: Tensor, run: Tensor, resamples: int) -> Tensor:
    """Return mean and bootstrap interval over runs of errors (blocks, steps): (steps, 3); NaN for one run."""
    groups = torch.unique(run, return_inverse=True)[1]
    count = int(groups.max()) + 1
    mean = sizes.mean(0)
    if count < 2:
        unknown = torch.full_like(mean, torch.nan)
        return torch.stack([mean, unknown, unknown], dim=1)
    summed = sizes.new_zeros((count, sizes.shape[1])).index_add(0, groups, sizes)
    counted = sizes.new_zeros(count).index_add(0, groups, torch.ones(len(run), dtype=sizes.dtype))
    drawn = torch.from_numpy(np.random.default_rng(0).integers(0, count, (resamples, count)))
    means = summed[drawn].sum(1) / counted[drawn].sum(1, keepdim=True)
    low, high = np.percentile(means.numpy(), _PERCENTILES, axis=0)
    return torch.stack([mean, torch.from_numpy(low), torch.from_numpy(high)], dim=1)
