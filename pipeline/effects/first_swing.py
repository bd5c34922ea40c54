"""How a slung load swings where a recording of it begins: from what is felt across the thrust."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import torch
from jaxtyping import Float, Shaped
from torch import Tensor

from simgap.physics import rotations
from simgap.physics.cable import Cable, across, along, pooled, pull, swing
from simgap.physics.shapes import Value

_COARSE_ANGLE = 0.15  # rad that a cable swings by in a step: an error of the start is no finer
_USUAL = 1.0  # rad, by which a cable may be off the apparent gravity at first
_GROWING = (0.25, 0.5, 0.75, 1.0)  # of what was felt: the shorter, the fewer the valleys of a wild swing
_CORRECTIONS = 3  # on each of them
_DAMPING = 0.01  # of a correction, at first
_EASED, _TIGHTENED = 0.25, 8.0  # what becomes of it where a correction helps, and where it does not
_SLIGHT_ANGLE = 1e-3  # rad, by which it is turned to see what that changes
_MEMORY = 0.2  # s, after which what is felt tells something new


@dataclass(frozen=True)
class Felt:
    """What is known of machines that carry a load, in steps of equal length.

    Attributes:
        apparent: gravity, world frame, (cables, steps, 3) m/s².
        attitude: (cables, steps, 4).
        counts: which steps count, (cables, steps).
    """

    apparent: Float[Tensor, "cables steps 3"]
    attitude: Float[Tensor, "cables steps 4"]
    counts: Shaped[Tensor, "cables steps"]

    def beginning(self, part: float) -> "Felt":
        """Return the first part of it."""
        steps = max(round(part * self.counts.shape[1]), 2)
        return Felt(self.apparent[:, :steps], self.attitude[:, :steps], self.counts[:, :steps])

    def sideways(
        self, acceleration: Float[Tensor, "*batch cables steps 3"]
    ) -> Float[Tensor, "*batch cables felt"]:
        """Return world-frame accelerations (..., cables, steps, 3) along body x and y, (..., cables, 2·steps)."""
        body = rotations.rotate_inverse(self.attitude.expand(*acceleration.shape[:-1], 4), acceleration)
        return (body[..., :2] * self.counts[..., None]).flatten(-2)


def first_swing(
    cable: Cable,
    apparent: Float[Tensor, "cables samples 3"],
    attitude: Float[Tensor, "cables samples 4"],
    counts: Shaped[Tensor, "cables samples"],
    mass_ratio: Value,
) -> tuple[Float[Tensor, "cables 3"], Float[Tensor, "cables 3"]]:
    """Return direction and rate with which the pull follows best what is felt across the thrust.

    Levenberg-Marquardt from rest, in coarse steps, over two angles and their rates, as far as they may usually be off;
    first along the beginning, then from where that leads to along more of it.

    Args:
        cable: that swings.
        apparent: gravity, world frame, (cables, samples, 3) m/s².
        attitude: (cables, samples, 4).
        counts: which samples count, (cables, samples).
        mass_ratio: of load and machine.
    """
    stride = cable.stride(_COARSE_ANGLE)
    means = pooled(apparent, stride)
    middles = (stride * torch.arange(means.shape[1]) + stride // 2).clamp_max(apparent.shape[1] - 1)
    felt = Felt(means, attitude[:, middles], counts[:, middles])
    search = _Search(cable, along(apparent[:, 0]), felt, stride, mass_ratio)
    off = torch.zeros(len(apparent), 4, dtype=apparent.dtype)
    for part in _GROWING:
        off = replace(search, felt=felt.beginning(part)).found(off)
    found = search.turned(off)
    later = 0.5 * (stride - cable.fine) * cable.time_step  # a step stands for its middle
    return swing(*found, means[:, 0], means[:, 0], cable.length, -later) if later else found


class Swung(NamedTuple):
    """What starts lead to.

    Attributes:
        off: by how much each start is off rest, (cables, 4).
        error: of what is felt, (cables, 2·steps) m/s².
        slopes: of what is felt against the start, (cables, 2·steps, 4).
    """

    off: Float[Tensor, "cables 4"]
    error: Float[Tensor, "cables felt"]
    slopes: Float[Tensor, "cables felt 4"]

    @property
    def cost(self) -> Float[Tensor, " cables"]:
        """The energy of the error of each start, (cables,)."""
        return self.error.square().sum(1)

    def or_else(self, other: "Swung") -> "Swung":
        """Return for each cable whichever errs less."""
        better = self.cost <= other.cost
        picked = (
            torch.where(better.view(-1, *[1] * (mine.dim() - 1)), mine, yours)
            for mine, yours in zip(self, other, strict=True)
        )
        return Swung(*picked)


@dataclass(frozen=True)
class _Search:
    """For the starts of cables: two angles off rest, and two rates over their pace.

    Attributes:
        cable: that swings.
        resting: direction of the apparent gravity at first, (cables, 3).
        felt: what is to be followed.
        stride: samples in a step.
        mass_ratio: of load and machine.
    """

    cable: Cable
    resting: Tensor
    felt: Felt
    stride: int
    mass_ratio: Tensor | float

    def found(self, off: Tensor) -> Tensor:
        """Return by how much the cables are off rest at first, looked for from a guess of it, (cables, 4) both."""
        best = self.swung(off)
        damping = torch.full((len(self.resting),), _DAMPING, dtype=self.resting.dtype)
        for _ in range(_CORRECTIONS):
            tried = self.swung(best.off + self.correction(best, damping))
            damping = torch.where(tried.cost < best.cost, _EASED * damping, _TIGHTENED * damping)
            best = tried.or_else(best)
        return best.off

    def swung(self, off: Tensor) -> Swung:
        """Return what starts lead to, and how that changes with them."""
        units = torch.eye(4, dtype=off.dtype)
        aside = _SLIGHT_ANGLE * torch.cat([torch.zeros_like(units[:1]), units])
        direction, rate = self.turned(off + aside[:, None])
        apparent = self.felt.apparent.expand(5, *self.felt.apparent.shape)
        swung = self.cable.steps(
            direction.flatten(0, 1), rate.flatten(0, 1), apparent.flatten(0, 1), self.stride
        )
        towards, turning = (each.unflatten(0, (5, -1)) for each in swung)
        shown = self.felt.sideways(self.mass_ratio * pull(towards, turning, apparent, self.cable.length))
        error = self.felt.sideways(-self.felt.apparent) - shown[0]
        return Swung(off, error, ((shown[1:] - shown[0]) / _SLIGHT_ANGLE).movedim(0, -1))

    def correction(self, swung: Swung, damping: Tensor) -> Tensor:
        """Return by how much starts have to be turned further, (cables, 4)."""
        independent = self.felt.counts.sum(1) * self.stride * self.cable.time_step / _MEMORY
        weight = independent / swung.cost.clamp_min(1e-12)
        square = weight[:, None, None] * swung.slopes.mT @ swung.slopes
        held = square.diagonal(dim1=1, dim2=2) * damping[:, None] + _USUAL**-2
        uphill = weight[:, None] * (swung.slopes.mT @ swung.error[..., None])[..., 0]
        return torch.linalg.solve(square + torch.diag_embed(held), uphill - swung.off / _USUAL**2)

    def turned(self, off: Tensor) -> tuple[Tensor, Tensor]:
        """Return direction and rate of cables off rest (..., cables, 4), (..., cables, 3) each."""
        axes = torch.eye(3, dtype=off.dtype)[:2, None]
        sides = across(axes.expand(2, *self.resting.shape), self.resting)
        aside, turning = (
            torch.einsum("...cs,scx->...cx", part, sides)
            for part in (off[..., :2], self.cable.pace * off[..., 2:])
        )
        turned = along(self.resting + aside)
        return turned, across(turning, turned)
