"""Profiles from rest to rest with bounded speed, acceleration and jerk, exact at every instant."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reference:
    """A motion along a line, piecewise polynomial in time; it starts at 0, at rest.

    Attributes:
        acceleration: m/s², over [0, duration] s.
        velocity: m/s.
        position: m.
    """

    acceleration: PPoly
    velocity: PPoly = field(init=False)
    position: PPoly = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "velocity", self.acceleration.antiderivative())
        object.__setattr__(self, "position", self.velocity.antiderivative())

    @property
    def duration(self) -> float:
        """From rest to rest, s."""
        return float(self.acceleration.x[-1])

    def velocities(self, times: Array) -> Array:
        """Return the velocity at times (samples,), s; 0 after the end."""
        return np.where(times < self.duration, self.velocity(np.minimum(times, self.duration)), 0.0)


def trapezoid(distance: float, speed: float, acceleration: float) -> Reference:
    """Return the fastest motion with bounded speed and acceleration; a triangle where the distance is short.

    Source: Biagiotti & Melchiorri 2008, "Trajectory planning for automatic machines and robots", §3.2.

    Args:
        distance: m.
        speed: greatest, m/s.
        acceleration: greatest, m/s².
    """
    peak = min(speed, math.sqrt(distance * acceleration))
    ramp = peak / acceleration
    cruise = distance / peak - ramp
    return _pieces([(ramp, acceleration, 0.0), (cruise, 0.0, 0.0), (ramp, -acceleration, 0.0)])


def s_curve(distance: float, speed: float, acceleration: float, jerk: float) -> Reference:
    """Return the fastest motion with bounded speed, acceleration and jerk, in up to seven pieces.

    Source: Biagiotti & Melchiorri 2008, "Trajectory planning for automatic machines and robots", §3.4.

    Args:
        distance: m.
        speed: greatest, m/s.
        acceleration: greatest, m/s².
        jerk: greatest, m/s³.
    """
    peak = min(speed, _highest_peak(distance, acceleration, jerk))
    reached = min(acceleration, math.sqrt(peak * jerk))
    bend, hold = reached / jerk, peak / reached - reached / jerk
    cruise = distance / peak - hold - 2.0 * bend
    up = [(bend, 0.0, jerk), (hold, reached, 0.0), (bend, reached, -jerk)]
    down = [(duration, -start, -slope) for duration, start, slope in up]
    return _pieces([*up, (cruise, 0.0, 0.0), *down])


def _highest_peak(distance: float, acceleration: float, jerk: float) -> float:
    """Return the speed that is reached where no bound on it intervenes, m/s."""
    bend = acceleration / jerk
    if distance < 2.0 * acceleration * bend * bend:  # the acceleration does not reach its bound
        return (0.25 * distance * distance * jerk) ** (1.0 / 3.0)
    return 0.5 * (math.sqrt((acceleration * bend) ** 2 + 4.0 * acceleration * distance) - acceleration * bend)


def _pieces(pieces: list[tuple[float, float, float]]) -> Reference:
    """Join pieces of a duration, s, an acceleration at the start, m/s², and its slope, m/s³; empty ones vanish."""
    lasting = [piece for piece in pieces if piece[0] > 1e-12]
    durations, starts, slopes = np.array(lasting, dtype=np.float64).T
    return Reference(PPoly(np.stack([slopes, starts]), np.concatenate([[0.0], np.cumsum(durations)])))
