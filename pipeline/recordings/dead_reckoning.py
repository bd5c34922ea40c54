"""Attitude, velocity and position of a flight from gyroscope and accelerometer alone."""

import numpy as np
from numpy.polynomial import Legendre
from scipy.integrate import cumulative_trapezoid
from scipy.spatial.transform import Rotation

_TREND_TIME = 10.0  # s in which a gyroscope drifts noticeably, and a flight in a room turns around


def dead_reckoning(
    time: np.ndarray, body_rate: np.ndarray, specific_force: np.ndarray, gravity: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return attitude (samples, 4), scalar-first, velocity and position (samples, 3) in the world frame.

    The gyroscope is integrated. What it drifts shows in the direction of the specific force, which a flight that stays
    in place must have upward on average: its trend, a polynomial of one degree per 10 s, is turned upright. What
    velocity and position drift nevertheless is taken out as a trend of one degree more each. Heading, velocity and
    position begin anywhere and mean little beyond some seconds; fast changes are what they are.
    Source: the idea of the complementary filter of Mahony, Hamel & Pflimlin 2008, "Nonlinear complementary filters on
    the special orthogonal group" (IEEE Transactions on Automatic Control 53), with all of the flight at hand.

    Args:
        time: s, shape (samples,).
        body_rate: rad/s, forward, left, up, its bias taken out, shape (samples, 3).
        specific_force: m/s², forward, left, up, shape (samples, 3).
        gravity: m/s².
    """
    degree = int((time[-1] - time[0]) / _TREND_TIME)
    turned = _integrated(time, body_rate)
    upward = _trend(time, turned.apply(specific_force), degree)
    attitude = _upright(upward) * turned
    acceleration = attitude.apply(specific_force) - np.array([0.0, 0.0, gravity])
    velocity = _without_trend(time, acceleration, degree + 1)
    position = _without_trend(time, velocity, degree + 2)
    return attitude.as_quat(scalar_first=True, canonical=False), velocity, position


def _integrated(time: np.ndarray, body_rate: np.ndarray) -> Rotation:
    """Return the rotation since the first sample, with the mean rate between two samples."""
    mean = 0.5 * (body_rate[1:] + body_rate[:-1])
    steps = Rotation.from_rotvec(mean * np.diff(time)[:, None]).as_quat().tolist()
    quaternions = [(0.0, 0.0, 0.0, 1.0)]
    for x, y, z, w in steps:
        a, b, c, d = quaternions[-1]
        quaternions.append(
            (
                d * x + a * w + b * z - c * y,
                d * y - a * z + b * w + c * x,
                d * z + a * y - b * x + c * w,
                d * w - a * x - b * y - c * z,
            )
        )
    return Rotation.from_quat(np.array(quaternions))


def _upright(direction: np.ndarray) -> Rotation:
    """Return the shortest rotations that turn directions (samples, 3) to +z."""
    unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    x, y, z = unit.T
    return Rotation.from_quat(np.column_stack([y, -x, np.zeros_like(z), 1.0 + z]))


def _without_trend(time: np.ndarray, rate: np.ndarray, degree: int) -> np.ndarray:
    """Return the integral of a rate over time less its polynomial trend."""
    integral = cumulative_trapezoid(rate, time, axis=0, initial=0.0)
    return integral - _trend(time, integral, degree)


def _trend(time: np.ndarray, series: np.ndarray, degree: int) -> np.ndarray:
    """Return the polynomial that fits a series (samples, 3) best."""
    return np.column_stack([Legendre.fit(time, column, degree)(time) for column in series.T])
