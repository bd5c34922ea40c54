"""Initial swing of a slung load, fitted to the accelerations across the thrust."""

import numpy as np
import torch
from jaxtyping import Float, Shaped
from numpy.typing import NDArray
from torch import Tensor

from simgap.physics import rotations
from simgap.physics.cable import Cable, across, along, pooled, swing
from simgap.physics.shapes import Value

_COARSE_ANGLE = 0.15  # rad of swing in a coarse step: finer steps do not improve the start
_MEMORY = 0.2  # s, correlation time of the accelerations


def first_swing(
    cable: Cable,
    apparent: Float[Tensor, "cables samples 3"],
    attitude: Float[Tensor, "cables samples 4"],
    counts: Shaped[Tensor, "cables samples"],
    mass_ratio: Value,
) -> tuple[Float[Tensor, "cables 3"], Float[Tensor, "cables 3"]]:
    """Return the direction and rate whose pull fits the accelerations across the thrust best.

    Levenberg-Marquardt in coarse steps over two angles and their rates, from rest and with a prior on their size. It
    fits the beginning first and continues from there along growing parts of the record. No gradients go through it.

    Args:
        cable: the swinging cable.
        apparent: gravity, world frame, (cables, samples, 3) m/s².
        attitude: (cables, samples, 4).
        counts: mask of valid samples, (cables, samples).
        mass_ratio: mass of the load over mass of the machine.
    """
    from simgap.physics.swing_search import Swinging, first_swings  # its import takes longer than all effects

    stride = cable.stride(_COARSE_ANGLE)
    means = pooled(apparent, stride).detach().double()
    middles = (stride * torch.arange(means.shape[1]) + stride // 2).clamp_max(apparent.shape[1] - 1)
    counted = counts[:, middles].double()
    axes = rotations.to_matrix(attitude[:, middles].detach().double())[..., :2].mT * counted[..., None, None]
    resting = along(apparent[:, 0].detach().double())
    sides = across(torch.eye(3, dtype=torch.float64)[:2].expand(len(resting), 2, 3), resting[:, None])
    length, pace, ratio = (float(each) for each in (cable.length, cable.pace, mass_ratio))
    swinging = Swinging(length, pace, stride * cable.time_step, ratio, _MEMORY)
    starts = first_swings(
        _array(means), _array(axes), _array(counted.cumsum(1)), _array(resting), _array(sides), swinging
    )
    towards, turning = (torch.from_numpy(each).to(apparent.dtype) for each in starts)
    later = 0.5 * (stride - cable.fine) * cable.time_step  # a step represents its middle
    gravity = means[:, 0].to(apparent.dtype)
    return swing(towards, turning, gravity, gravity, cable.length, -later) if later else (towards, turning)


def _array(series: Tensor) -> NDArray[np.float64]:
    return series.contiguous().numpy()
