"""Laps of an arena: legs from stop to stop at different speeds, with superposed rotation."""

import numpy as np
from numpy.typing import NDArray

from simgap.plants.rotation import Array
from simgap.plants.swerve.case import SwerveCase

_LAP = 12.0  # s, in which the course goes all the way round
_PACES = (0.2, 1.0)  # of the greatest speed, on a leg
_HASTE = (1.0, 1.6)  # duration of a leg over the shortest that the acceleration allows
_STOP = 0.4  # s between two legs, in which the modules are turned
_YAW_SHARES = (0.2, 0.6)  # of a module's speed that comes from yaw, over that from travel
_PIROUETTES = 0.3  # share of the legs that are rotation for the greater part
_DRIFTS = (0.0, 0.3)  # on those: of a module's speed that comes from travel, over that from yaw


def laps(
    case: SwerveCase, modules: Array, times: Array, random: np.random.Generator
) -> tuple[Array, Array, Array]:
    """Return angles, rad, and speeds, m/s, of the modules (steps, 4) and the yaw rate (steps,), rad/s.

    At a stop each module turns to the nearer of the two angles at which its wheel rolls along the next leg.
    """
    size, leg = _legs(case, times, random)
    travel, turning = _shares(int(leg[-1]) + 1, random)
    travel, turning = travel[leg], turning[leg] / np.hypot(*modules.T).max()
    course = random.uniform(-np.pi, np.pi) + random.choice([-1.0, 1.0]) * 2.0 * np.pi * times / _LAP
    x = (travel * np.cos(course))[:, None] - turning[:, None] * modules[:, 1]
    y = (travel * np.sin(course))[:, None] + turning[:, None] * modules[:, 0]
    straight = np.arctan2(y, x)
    angle = np.unwrap(straight, period=np.pi, axis=0)
    speed = np.hypot(x, y) * size[:, None] * np.cos(angle - straight).round()
    return _turned_at_stops(angle, size == 0.0), speed, turning * size


def _legs(case: SwerveCase, times: Array, random: np.random.Generator) -> tuple[Array, NDArray[np.int64]]:
    """Return the speed of the fastest module (steps,), m/s, and the number of the leg at each step."""
    steepest = np.pi * case.speed / case.acceleration  # s: a raised cosine is steepest by π·top/duration
    count = 1 + int((times[-1] - times[0]) / (steepest * _PACES[0] + _STOP))
    pace = random.uniform(*_PACES, count)
    duration = steepest * pace * random.uniform(*_HASTE, count)
    ends = times[0] + np.cumsum(duration + _STOP)
    leg = np.searchsorted(ends, times, side="right")
    phase = np.clip(1.0 - (ends[leg] - times - 0.5 * _STOP) / duration[leg], 0.0, 1.0)
    way = random.choice([-1.0, 1.0], count)
    return case.speed * (way * pace)[leg] * 0.5 * (1.0 - np.cos(2.0 * np.pi * phase)), leg


def _shares(legs: int, random: np.random.Generator) -> tuple[Array, Array]:
    """Return by leg the shares of travel and of rotation, with sign, in the speed of the fastest module."""
    spinning = random.random(legs) < _PIROUETTES
    travel = np.where(spinning, random.uniform(*_DRIFTS, legs), 1.0)
    turning = np.where(spinning, 1.0, random.uniform(*_YAW_SHARES, legs))
    fastest = travel + turning
    return travel / fastest, random.choice([-1.0, 1.0], legs) * turning / fastest


def _turned_at_stops(angle: Array, standing: NDArray[np.bool_]) -> Array:
    """Return angles (steps, 4) that go from leg to leg along a raised cosine while the robot stands."""
    edges = np.diff(standing.astype(int), prepend=0, append=0)
    for first, after in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        last = after - 1
        share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, after - first))
        angle[first:after] = angle[first] + share[:, None] * (angle[last] - angle[first])
    return angle
