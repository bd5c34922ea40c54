"""Which four signals are a quaternion, in which order, and which three are the body rates that turn it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simgap.logs.common_times import values_at
from simgap.logs.log import Signal

_NORM = 0.02  # by which the norm of a logged quaternion is off 1
_LAG = 5  # samples over which rotations are compared
_LONGEST = 0.5  # rad; of larger rotations the vector is no integral of the rates
_FEWEST = 50
_MOST = 40_000  # samples that are looked at
_STEPS = 20.0  # median steps; a rotation over a longer one is left out


@dataclass(frozen=True)
class Turn:
    """How body rates follow the rotation of a quaternion.

    Attributes:
        scalar_first: whether the first of the four signals is the scalar.
        factors: of each axis: rotation in rad over the integral of the rate.
        correlation: the least of the three axes.
    """

    scalar_first: bool
    factors: tuple[float, float, float]
    correlation: float

    @property
    def is_rotation(self) -> bool:
        """Whether other axes, or the opposite direction of turning, explain the signs; else it is a mirror image."""
        negative = sum(factor < 0 for factor in self.factors)
        return negative in (0, 2, 3)


def is_quaternion(parts: Sequence[Signal]) -> bool:
    """Whether four signals at the same times have norm one, and turn."""
    if len({len(part.time) for part in parts}) != 1:
        return False
    values = np.stack([part.values for part in parts], axis=1)
    norms = np.linalg.norm(values[np.isfinite(values).all(axis=1)], axis=1)
    if len(norms) < _FEWEST or np.median(np.abs(norms - 1.0)) > _NORM:
        return False
    return bool(np.nanstd(values, axis=0).max() > 1e-3)  # a reference that never turns shows nothing


def turn_of(quaternion: Sequence[Signal], rates: Sequence[Signal]) -> Turn | None:
    """Return how rates follow a quaternion, scalar first or last; None where they cannot be compared."""
    time = quaternion[0].time[:_MOST]
    values = np.stack([part.values[:_MOST] for part in quaternion], axis=1)
    rate = np.stack([values_at(part, time, held=part.held) for part in rates], axis=1)
    known = np.isfinite(values).all(axis=1) & np.isfinite(rate).all(axis=1)
    time, values, rate = time[known], values[known], rate[known]
    if len(time) < _FEWEST:
        return None
    steps = np.diff(time)
    integral = np.concatenate(
        [np.zeros((1, 3)), np.cumsum(0.5 * (rate[1:] + rate[:-1]) * steps[:, None], axis=0)]
    )
    span = time[_LAG:] - time[:-_LAG]
    near = (span > 0) & (span < _STEPS * _LAG * np.median(steps))
    turned = (integral[_LAG:] - integral[:-_LAG])[near]
    tried = []
    for scalar_first in (True, False):
        order = values if scalar_first else np.roll(values, 1, axis=1)
        rotated = _rotation(order[:-_LAG], order[_LAG:])[near]
        tried.append(_compared(rotated, turned, scalar_first))
    return max((turn for turn in tried if turn is not None), key=lambda turn: turn.correlation, default=None)


def _compared(rotated: NDArray[np.float64], turned: NDArray[np.float64], scalar_first: bool) -> Turn | None:
    small = np.linalg.norm(rotated, axis=1) < _LONGEST
    rotated, turned = rotated[small], turned[small]
    power, square, product = (
        (a * b).sum(axis=0) for a, b in ((rotated, rotated), (turned, turned), (rotated, turned))
    )
    if len(rotated) < _FEWEST or (square <= 0).any() or (power <= 0).any():
        return None
    factors = product / square
    correlation = float(np.abs(product / np.sqrt(square * power)).min())
    return Turn(scalar_first, (float(factors[0]), float(factors[1]), float(factors[2])), correlation)


def _rotation(begin: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation vector from one quaternion to another in the body frame, rad, (n, 3)."""
    w = (begin * end).sum(axis=1)
    vector = (
        begin[:, :1] * end[:, 1:] - end[:, :1] * begin[:, 1:] - np.cross(begin[:, 1:], end[:, 1:])
    ) * np.where(w < 0, -1.0, 1.0)[:, None]
    size = np.linalg.norm(vector, axis=1)
    angle = 2.0 * np.arctan2(size, np.abs(w))
    return np.asarray(vector * np.where(size > 1e-12, angle / np.maximum(size, 1e-12), 2.0)[:, None])
