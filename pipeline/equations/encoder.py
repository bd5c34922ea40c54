"""The steps of an encoder, and when an axis rests on one of them.

A velocity that is derived from a position jumps with each step of the encoder, also while the axis rests on the edge
between two of them. That motion has no direction, and friction must not be taken to oppose it.
"""

import torch
from jaxtyping import Bool
from torch import Tensor, nn

from simgap.physics.shapes import Series

_REST = 0.1
"""Time on both sides of a sample in which an axis at rest stays within a step, s: half of the widest window of rows."""
_WITHIN = 1.5  # steps: halfway between the one that an axis at rest may show, and two
_NEIGHBOURS = 3.5
"""Steps between two levels that tell whether these lie on a grid: over more of them rounded numbers drift."""
_OFF_GRID, _GRID_SHARE, _FEWEST_GAPS = 0.1, 0.9, 8
"""Multiples of a step are whole within a tenth. One number in five is so by chance, and the seven beside the least of
eight numbers once in eighty thousand cases."""
_SAME_LEVEL = 1e-9  # of the greatest position: rounding makes no other level


def encoder_step(position: Series) -> float:
    """Return the step of the encoder of a position (blocks, samples, ...), in its unit; 0 where it shows none.

    A position that is held for two samples lies on a level of the encoder, also where samples between two levels were
    interpolated. Levels that follow each other in one block are whole numbers of steps apart. Those of an axis that
    rests at places of a finer sensor are not.
    """
    series = position.movedim(1, -1).flatten(0, -2)
    held = series.diff(dim=-1) == 0.0
    levels = torch.where(held, series[:, 1:], torch.inf).sort(dim=-1).values
    gaps = levels.diff(dim=-1)
    gaps = gaps[gaps.isfinite() & (gaps > _SAME_LEVEL * series.abs().max())]
    if len(gaps) < _FEWEST_GAPS:
        return 0.0
    step = float(gaps.min())
    apart = gaps[gaps < _NEIGHBOURS * step] / step
    on_grid = (apart - apart.round()).abs() < _OFF_GRID
    certain = len(apart) >= _FEWEST_GAPS and float(on_grid.double().mean()) >= _GRID_SHARE
    return step if certain else 0.0


def resting(position: Series, step: float, time_step: float) -> Bool[Tensor, "blocks samples *rest"]:
    """Return where a position stays within a step of its encoder for a while.

    Args:
        position: (blocks, samples, ...) rad or m.
        step: of the encoder, in the same unit.
        time_step: between samples, s.
    """
    reach = max(1, round(_REST / time_step))
    series = position.movedim(1, -1)
    rows = nn.functional.pad(series.reshape(-1, 1, series.shape[-1]), (reach, reach), mode="replicate")
    width = 2 * reach + 1
    highest = nn.functional.max_pool1d(rows, width, stride=1)
    lowest = -nn.functional.max_pool1d(-rows, width, stride=1)
    return (highest - lowest < _WITHIN * step).reshape(series.shape).movedim(-1, 1)
