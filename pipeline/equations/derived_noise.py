"""Noise of rows whose velocity nobody recorded: it was derived from the position, whose noise is in both.

The noise of a derivative grows with the frequency. A fifth difference, which tells white noise, shows much more of it
than a smooth window keeps; and the noise of the velocity is that of the position, which acts in a loop, too. So the
position's own noise is measured, and as much is added to the position and to its derivative: what the rows change by is
their noise.
"""

from dataclasses import replace

import torch
from torch import Tensor

from simgap.equations.residuals import channel_series, residual_rows
from simgap.equations.sample_noise import sample_noise
from simgap.physics.weak_form import WindowFunctions
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_SEED = 0


def noise_of_derived(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return the standard deviation that the noise of position and input gives each channel's rows, (channels,)."""
    moved = shaken_position(blocks)
    changed = residual_rows(simulator, moved, functions) - residual_rows(simulator, blocks, functions)
    variance = changed.square().mean((0, 1))
    if "position_command" not in blocks.signals:
        variance = variance + _of_input(simulator, blocks, functions)
    return variance.sqrt()


def shaken_position(blocks: Blocks, share: float = 1.0) -> Blocks:
    """Return blocks whose position holds a share of its white noise again, and whose velocity is derived from it."""
    position = blocks.signals["position"]
    size = share * sample_noise(blocks.inner(position), blocks.noise_kept).sqrt()
    random = torch.Generator().manual_seed(_SEED)
    noise = size * torch.randn(position.shape, generator=random, dtype=position.dtype)
    velocity = blocks.signals["velocity"] + _slope(noise, blocks.time_step)
    return replace(blocks, signals=blocks.signals | {"position": position + noise, "velocity": velocity})


def _of_input(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return the variance by the noise of a measured voltage or effort; a program's positions have none."""
    gain = functions.weights.square().sum(1).mean()
    series = channel_series(simulator, replace(blocks, held=False))
    return gain * torch.stack([sample_noise(each.predicted, blocks.noise_kept) for each in series])


def _slope(series: Tensor, time_step: float) -> Tensor:
    """Return the derivative of blocks (blocks, samples) as a quartic through five samples has it; see `derivative`."""
    near = series[:, 3:-1] - series[:, 1:-3]
    far = series[:, 4:] - series[:, :-4]
    inner = (8.0 * near - far) / (12.0 * time_step)
    (ends,) = torch.gradient(series, spacing=time_step, dim=1)
    return torch.cat([ends[:, :2], inner, ends[:, -2:]], dim=1)
