"""How wide the windows are that the equations of motion are averaged over: as wide as the motion is slow.

A window of width W shows what changes more slowly than about 1/W and averages the rest away: noise, and motion as well
where it is fast. What both sides of an equation share is motion: their covariance C over the windows, as far as it is
beyond chance. Of slow motion narrower windows show no more; of a flat spectrum C goes with 1/W; of fast motion C grows
more. So the width with the greatest |C|·W is wide enough to average noise and narrow enough to show the motion.
"""

import torch
from torch import Tensor

from simgap.equations.residuals import channel_series, measured_rows
from simgap.physics.weak_form import LEAST_WINDOW, mean_of, window_functions
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_CERTAIN = 2.0
"""Standard errors that a covariance has to exceed: 95 %."""


def width_of(simulator: Simulator, blocks: Blocks, widest: float) -> float:
    """Return the width of windows, s: the widest that suits one of the channels.

    Args:
        simulator: nominal.
        blocks: recorded.
        widest: width for slow motion, s; halves of it are tried, down to the fewest samples of a window.
    """
    widths = _halves(widest, LEAST_WINDOW * blocks.time_step)
    shared = torch.stack([width * _shared(simulator, blocks, width) for width in widths])
    return widths[int(shared.argmax(0).min())]


def _halves(widest: float, least: float) -> list[float]:
    widths = [widest]
    while widths[-1] > least:
        widths.append(max(widths[-1] / 2.0, least))
    return widths


def _shared(simulator: Simulator, blocks: Blocks, width: float) -> Tensor:
    """Return the size of the covariance of both sides of each equation over windows beyond chance, (channels,)."""
    functions = window_functions(blocks.samples, width, blocks.time_step)
    sizes = []
    for series in channel_series(simulator, blocks):
        measured, predicted = measured_rows(series, blocks, functions), mean_of(functions, series.predicted)
        by_chance = (measured.square().mean() * predicted.square().mean() / measured.numel()).sqrt()
        sizes.append(((measured * predicted).mean().abs() - _CERTAIN * by_chance).clamp_min(0.0))
    return torch.stack(sizes)
