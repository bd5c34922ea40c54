"""Initial swing of a slung load, fitted to the accelerations across the thrust."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import torch
from jaxtyping import Float, Shaped
from torch import Tensor

from simgap.physics import rotations
from simgap.physics.cable import Cable, across, along, pooled, pull, swing
from simgap.physics.shapes import Value

_COARSE_ANGLE = 0.15  # rad of swing in a coarse step: finer steps do not improve the start
_USUAL = 1.0  # rad, prior deviation of the cable from the apparent gravity
_GROWING = (0.25, 0.5, 0.75, 1.0)  # parts of the record: a shorter part has fewer local minima
_CORRECTIONS = 3  # Levenberg-Marquardt steps on each part
_DAMPING = 0.01  # initial damping of a step
_EASED, _TIGHTENED = 0.25, 8.0  # its factor after a better and after a worse step
_SLIGHT_ANGLE = 1e-3  # rad, step of the finite differences
_MEMORY = 0.2  # s, correlation time of the accelerations


@dataclass(frozen=True)
class Felt:
    """Measurements of machines that carry a load, in steps of equal length.

    Attributes:
        apparent: gravity, world frame, (cables, steps, 3) m/s².
        attitude: (cables, steps, 4).
        counts: mask of valid steps, (cables, steps).
    """

    apparent: Float[Tensor, "cables steps 3"]
    attitude: Float[Tensor, "cables steps 4"]
    counts: Shaped[Tensor, "cables steps"]

    def beginning(self, part: float) -> "Felt":
        """Return the first part of the steps."""
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
    """Return the direction and rate whose pull fits the accelerations across the thrust best.

    Levenberg-Marquardt in coarse steps over two angles and their rates, from rest and with a prior on their size. It
    fits the beginning first and continues from there along growing parts of the record.

    Args:
        cable: the swinging cable.
        apparent: gravity, world frame, (cables, samples, 3) m/s².
        attitude: (cables, samples, 4).
        counts: mask of valid samples, (cables, samples).
        mass_ratio: mass of the load over mass of the machine.
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
    later = 0.5 * (stride - cable.fine) * cable.time_step  # a step represents its middle
    return swing(*found, means[:, 0], means[:, 0], cable.length, -later) if later else found


class Swung(NamedTuple):
    """Result of simulated swings.

    Attributes:
        off: deviation of each start from rest, (cables, 4).
        error: error of the accelerations, (cables, 2·steps) m/s².
        slopes: derivative of the accelerations by the start, (cables, 2·steps, 4).
    """

    off: Float[Tensor, "cables 4"]
    error: Float[Tensor, "cables felt"]
    slopes: Float[Tensor, "cables felt 4"]

    @property
    def cost(self) -> Float[Tensor, " cables"]:
        """The sum of squared errors of each start, (cables,)."""
        return self.error.square().sum(1)

    def or_else(self, other: "Swung") -> "Swung":
        """Return the better result for each cable."""
        better = self.cost <= other.cost
        picked = (
            torch.where(better.view(-1, *[1] * (mine.dim() - 1)), mine, yours)
            for mine, yours in zip(self, other, strict=True)
        )
        return Swung(*picked)


@dataclass(frozen=True)
class _Search:
    """Search for the starts of cables: two angles from rest, and two rates relative to the natural frequency.

    Attributes:
        cable: the swinging cable.
        resting: initial direction of the apparent gravity, (cables, 3).
        felt: the accelerations to fit.
        stride: samples in a step.
        mass_ratio: of load and machine.
    """

    cable: Cable
    resting: Tensor
    felt: Felt
    stride: int
    mass_ratio: Tensor | float

    def found(self, off: Tensor) -> Tensor:
        """Return the initial deviations of the cables from rest, searched from a guess, (cables, 4) both."""
        best = self.swung(off)
        damping = torch.full((len(self.resting),), _DAMPING, dtype=self.resting.dtype)
        for _ in range(_CORRECTIONS):
            tried = self.swung(best.off + self.correction(best, damping))
            damping = torch.where(tried.cost < best.cost, _EASED * damping, _TIGHTENED * damping)
            best = tried.or_else(best)
        return best.off

    def swung(self, off: Tensor) -> Swung:
        """Return the swings from these starts, with their derivatives."""
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
        """Return the next step of the starts, (cables, 4)."""
        independent = self.felt.counts.sum(1) * self.stride * self.cable.time_step / _MEMORY
        weight = independent / swung.cost.clamp_min(1e-12)
        square = weight[:, None, None] * swung.slopes.mT @ swung.slopes
        held = square.diagonal(dim1=1, dim2=2) * damping[:, None] + _USUAL**-2
        uphill = weight[:, None] * (swung.slopes.mT @ swung.error[..., None])[..., 0]
        return torch.linalg.solve(square + torch.diag_embed(held), uphill - swung.off / _USUAL**2)

    def turned(self, off: Tensor) -> tuple[Tensor, Tensor]:
        """Return direction and rate of cables deviated from rest by (..., cables, 4), (..., cables, 3) each."""
        axes = torch.eye(3, dtype=off.dtype)[:2, None]
        sides = across(axes.expand(2, *self.resting.shape), self.resting)
        aside, turning = (
            torch.einsum("...cs,scx->...cx", part, sides)
            for part in (off[..., :2], self.cable.pace * off[..., 2:])
        )
        turned = along(self.resting + aside)
        return turned, across(turning, turned)
