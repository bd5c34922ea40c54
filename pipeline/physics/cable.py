"""Spherical pendulum: a point mass on a massless taut cable below a moving end.

Directions and accelerations are in the world frame. What acts on the load is the apparent gravity: gravity less the
acceleration of the cable's upper end.
"""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from numpy.typing import NDArray
from torch import Tensor

from simgap.physics.rotations import dot
from simgap.physics.shapes import Real, Signal, Value, Vector
from simgap.physics.tracing import may_run_compiled

Directions = Float[Tensor, "cables samples 3"]

_FINE = 0.04  # rad that a cable swings by in a step


@dataclass(frozen=True)
class Cable:
    """A cable with a sampled motion of its upper end.

    Attributes:
        length: m.
        gravity: m/s².
        time_step: of the samples, s.
    """

    length: Value
    gravity: float
    time_step: float

    @property
    def pace(self) -> Real:
        """How fast it swings, rad/s."""
        return (self.gravity / torch.as_tensor(self.length, dtype=torch.float64)).sqrt()

    def stride(self, turn: float) -> int:
        """Return how many samples are a step in which it swings by an angle in rad, at least one."""
        return max(int(turn / self.pace.item() / self.time_step), 1)

    @property
    def fine(self) -> int:
        """How many samples are a step in which it swings by so little that no finer one is needed."""
        return self.stride(_FINE)

    def swings(
        self, direction: Float[Tensor, "cables 3"], rate: Float[Tensor, "cables 3"], apparent: Directions
    ) -> tuple[Directions, Directions]:
        """Return direction and rate of cables along samples of apparent gravity (cables, samples, 3) from a start.

        The start is that in the middle of the first fine step. A step is as many samples as make a small part of a
        swing, over the mean of what acts; in between, both change linearly.
        """
        found = self.steps(direction, rate, pooled(apparent, self.fine), self.fine)
        direction, rate = (_spread(series, self.fine, apparent.shape[1]) for series in found)
        return along(direction), rate

    def steps(
        self,
        direction: Float[Tensor, "cables 3"],
        rate: Float[Tensor, "cables 3"],
        means: Directions,
        stride: int,
    ) -> tuple[Directions, Directions]:
        """Return direction and rate of cables over steps of so many samples, (cables, steps, 3) each.

        A compiled loop takes the steps where nobody asks for more than their numbers.
        """
        time_step = stride * self.time_step
        length = torch.as_tensor(self.length, dtype=torch.float64)
        if not may_run_compiled((direction, rate, means, length)):
            return self._one_by_one(direction, rate, means, time_step)
        from simgap.physics.cable_steps import swung  # its import takes longer than all effects

        directions, rates = swung(
            _array(direction), _array(rate), _array(means), _array(length.expand(len(means))), time_step
        )
        return torch.from_numpy(directions).to(means.dtype), torch.from_numpy(rates).to(means.dtype)

    def _one_by_one(
        self, direction: Tensor, rate: Tensor, means: Tensor, time_step: float
    ) -> tuple[Tensor, Tensor]:
        directions, rates = [direction], [rate]
        for before, after in zip(means[:, :-1].unbind(1), means[:, 1:].unbind(1), strict=True):
            direction, rate = swing(direction, rate, before, after, self.length, time_step)
            directions.append(direction)
            rates.append(rate)
        return torch.stack(directions, 1), torch.stack(rates, 1)


def swing(
    direction: Vector, rate: Vector, before: Vector, after: Vector, length: float | Signal, time_step: float
) -> tuple[Vector, Vector]:
    """Return direction and rate of a cable a step later.

    Source: Hairer, Lubich & Wanner 2006, Geometric numerical integration, §VII.1.4: RATTLE, second order.

    Args:
        direction: of the cable away from its upper end, unit, (..., 3).
        rate: of the direction, across it, (..., 3) 1/s.
        before: apparent gravity at the start of the step, (..., 3) m/s².
        after: at its end.
        length: of the cable, m.
        time_step: s.
    """
    kick = 0.5 * time_step / length
    free = direction + time_step * (rate + kick * before)
    onward, size = dot(free, direction)[..., None], dot(free, free)[..., None]
    turned = free + ((onward * onward - size + 1.0).clamp_min(0.0).sqrt() - onward) * direction
    return turned, across((turned - direction) / time_step + kick * after, turned)


def pull(direction: Vector, rate: Vector, apparent: Vector, length: Value) -> Vector:
    """Return the cable's tension per mass of the load along its direction, m/s²; a cable does not push."""
    tension = length * dot(rate, rate) + dot(direction, apparent)
    return tension.clamp_min(0.0)[..., None] * direction


def along(vector: Vector) -> Vector:
    """Return the direction of vectors (..., 3); straight down where there is none."""
    down = torch.zeros_like(vector)
    down[..., 2] = -1.0
    size = torch.linalg.vector_norm(vector.detach(), dim=-1, keepdim=True)
    safe = torch.where(size > 0.0, vector, down)
    return safe / torch.linalg.vector_norm(safe, dim=-1, keepdim=True)


def across(vector: Vector, direction: Vector) -> Vector:
    """Return the components of vectors (..., 3) perpendicular to unit directions (..., 3)."""
    return vector - dot(vector, direction)[..., None] * direction


def pooled(series: Directions, stride: int) -> Float[Tensor, "cables strides 3"]:
    """Return the means of every so many samples of a series (cables, samples, 3), the last one held where it ends."""
    missing = -series.shape[1] % stride
    whole = torch.cat([series, series[:, -1:].expand(-1, missing, -1)], dim=1)
    return whole.unflatten(1, (-1, stride)).mean(2)


def _array(series: Tensor) -> NDArray[np.float64]:
    return series.double().contiguous().numpy()


def _spread(series: Tensor, stride: int, samples: int) -> Tensor:
    """Return a series (cables, steps, 3) of the middles of steps at every sample, (cables, samples, 3)."""
    if stride == 1:
        return series
    linear = torch.nn.functional.interpolate(series.transpose(1, 2), scale_factor=stride, mode="linear")
    return linear.transpose(1, 2)[:, :samples]
