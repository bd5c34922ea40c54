"""How a slung load swings where a recording of it begins: from what is felt across the thrust."""

from dataclasses import dataclass

import torch
from torch import Tensor

from pipeline.physics import rotations
from pipeline.physics.cable import Cable, across, along, pooled, pull

_COARSE = 0.15  # rad that a cable swings by in a step: an error of the start is no finer than what is felt
_USUAL = 0.3  # rad, by which a cable may be off the apparent gravity at first
_CORRECTIONS = 2
_SLIGHT = 1e-3  # rad, by which it is turned to see what that changes
_MEMORY = 0.2  # s, after which what is felt tells something new


@dataclass(frozen=True)
class Felt:
    """What is known of machines that carry a load, in steps of equal length.

    Attributes:
        apparent: gravity, world frame, (cables, steps, 3) m/s².
        attitude: (cables, steps, 4).
        counts: which steps count, (cables, steps).
    """

    apparent: Tensor
    attitude: Tensor
    counts: Tensor

    def sideways(self, acceleration: Tensor) -> Tensor:
        """Return accelerations (cables, steps, 3) of the world frame along body x and y, (cables, 2·steps)."""
        body = rotations.rotate_inverse(self.attitude, acceleration)
        return (body[..., :2] * self.counts[..., None]).flatten(1)


def first_swing(
    cable: Cable, apparent: Tensor, attitude: Tensor, counts: Tensor, mass_ratio: Tensor | float
) -> tuple[Tensor, Tensor]:
    """Return direction and rate with which the pull follows best what is felt across the thrust.

    Gauss-Newton from rest, in coarse steps, over two angles and their rates, as far as they may usually be off.

    Args:
        cable: that swings.
        apparent: gravity, world frame, (cables, samples, 3) m/s².
        attitude: (cables, samples, 4).
        counts: which samples count, (cables, samples).
        mass_ratio: of load and machine.
    """
    stride = cable.stride(_COARSE)
    means = pooled(apparent, stride)
    middles = (stride * torch.arange(means.shape[1]) + stride // 2).clamp_max(apparent.shape[1] - 1)
    felt = Felt(means, attitude[:, middles], counts[:, middles])
    resting = along(apparent[:, 0])
    off = torch.zeros(len(apparent), 4, dtype=apparent.dtype)
    for _ in range(_CORRECTIONS):
        off = off + _correction(cable, resting, off, felt, stride, mass_ratio)
    return _turned(cable, resting, off)


def _correction(
    cable: Cable, resting: Tensor, off: Tensor, felt: Felt, stride: int, mass_ratio: Tensor | float
) -> Tensor:
    """Return by how much the start has to be turned further, (cables, 4)."""
    units = torch.eye(4, dtype=off.dtype)
    moved = [off, *(off + _SLIGHT * unit for unit in units)]
    starts = zip(*(_turned(cable, resting, each) for each in moved), strict=True)
    direction, rate = (torch.cat(part) for part in starts)
    whole = felt.apparent.repeat(len(moved), 1, 1)
    swung = cable.steps(direction, rate, whole, stride)
    pulls = (mass_ratio * pull(*swung, whole, cable.length)).unflatten(0, (len(moved), -1))
    shown = torch.stack([felt.sideways(each) for each in pulls])
    slopes = ((shown[1:] - shown[0]) / _SLIGHT).movedim(0, -1)
    error = felt.sideways(-felt.apparent) - shown[0]
    independent = felt.counts.sum(1) * stride * cable.time_step / _MEMORY
    weight = independent / error.square().sum(1).clamp_min(1e-12)
    square = weight[:, None, None] * slopes.mT @ slopes + units / _USUAL**2
    uphill = weight[:, None] * (slopes.mT @ error[..., None])[..., 0] - off / _USUAL**2
    return torch.linalg.solve(square, uphill)


def _turned(cable: Cable, resting: Tensor, off: Tensor) -> tuple[Tensor, Tensor]:
    """Return direction and rate of cables off rest by two angles, and by two rates over their pace, (cables, 4)."""
    axes = torch.eye(3, dtype=resting.dtype)[:2]
    sides = torch.stack([across(axis.expand_as(resting), resting) for axis in axes])
    aside, turning = ((part.T[..., None] * sides).sum(0) for part in (off[:, :2], cable.pace * off[:, 2:]))
    turned = along(resting + aside)
    return turned, across(turning, turned)
