"""The attitude of a quadrotor against its body rate, its accelerometer and its acceleration."""

from collections.abc import Iterator

import numpy as np

from simgap.consistency.redundancy import Pair
from simgap.consistency.samples import Samples

_GRAVITY = 9.81  # m/s²
_LEAST_RATE = 0.05  # rad/s: the zero error of a cheap gyroscope
_LEAST_COMMAND = 0.3  # rad/s: what a controller asks for and does not get
_LEAST_FORCE = 0.5  # m/s²: the zero error and the vibrations of a cheap accelerometer
_DOUBTED = 0.1  # an exact relation, in which gravity hides much of the motion
_LEAST_TILT = 1.0  # m/s²: an estimated velocity is smoother than the true one


def turning_pairs(samples: Samples) -> Iterator[Pair]:
    """Yield each body rate against the turning of the attitude."""
    jitter = 2.0 * max(samples.noise_of_rate(samples[f"attitude_{axis}"]) for axis in "wxyz")
    for axis, derived in zip("xyz", _turning(samples).T, strict=True):
        rate = samples[f"body_rate_{axis}"]
        noise = max(_LEAST_RATE, samples.noise_of_mean(rate), jitter)
        name = f"'body_rate_{axis}' against the turning of the attitude"
        yield Pair(name, (f"body_rate_{axis}", "attitude"), samples.mean(rate), derived, noise)


def force_pairs(samples: Samples) -> Iterator[Pair]:
    """Yield the accelerometer against gravity and acceleration."""
    felt = in_body(samples, acceleration(samples))
    for axis, derived in zip("xyz", felt.T, strict=True):
        force = samples[f"specific_force_{axis}"]
        name = f"'specific_force_{axis}' against gravity and the rate of change of the velocity"
        columns = (f"specific_force_{axis}", "attitude", "velocity")
        yield Pair(name, columns, samples.mean(force), derived, _LEAST_FORCE, _DOUBTED)


def command_pairs(samples: Samples) -> Iterator[Pair]:
    """Yield each body rate that was commanded against the recorded one."""
    for axis in "xyz":
        commanded, rate = samples[f"body_rate_command_{axis}"], samples[f"body_rate_{axis}"]
        name = f"'body_rate_command_{axis}' against 'body_rate_{axis}'"
        columns = (f"body_rate_command_{axis}", f"body_rate_{axis}")
        noise = max(_LEAST_COMMAND, samples.noise_of_mean(rate))
        yield Pair(name, columns, samples.mean(commanded), samples.mean(rate), noise)


def acceleration(samples: Samples) -> np.ndarray:
    """Return what an accelerometer at rest in the world would add to: dv/dt minus gravity's, (windows, 3) m/s²."""
    result = samples.rate(samples.stack("velocity", "xyz"))
    result[:, 2] += _GRAVITY
    return result


def in_body(samples: Samples, vectors: np.ndarray) -> np.ndarray:
    """Return vectors of the world in body axes, (windows, 3)."""
    matrix = matrices(samples.stack("attitude", "wxyz")[samples.centres])
    return np.einsum("nji,nj->ni", matrix, vectors)


def matrices(quaternions: np.ndarray) -> np.ndarray:
    """Return rotation matrices of quaternions (n, 4), scalar first, body to world, (n, 3, 3)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _turning(samples: Samples) -> np.ndarray:
    """Return the body rate by which the attitude turns over each window, (windows, 3) rad/s."""
    before, after = samples.ends(samples.stack("attitude", "wxyz"))
    w0, v0, w1, v1 = before[:, :1], before[:, 1:], after[:, :1], after[:, 1:]
    scalar = w0 * w1 + (v0 * v1).sum(axis=1, keepdims=True)
    vector = w0 * v1 - w1 * v0 - np.cross(v0, v1)
    vector = np.where(scalar < 0.0, -vector, vector)
    sine = np.linalg.norm(vector, axis=1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, np.abs(scalar))
    with np.errstate(invalid="ignore", divide="ignore"):
        axis = np.where(sine > 0.0, vector / sine, 0.0)
    return axis * angle / samples.span[:, None]


def tilt_pairs(samples: Samples) -> Iterator[Pair]:
    """Yield the horizontal acceleration against that of a thrust along the body's z axis, both without drag.

    The vertical acceleration says how strong the thrust is, the attitude where it points. What goes with the speed,
    its square or is constant is drag, wind or an error of the level: it is taken out of both sides.
    """
    total = acceleration(samples)
    pointing = matrices(samples.stack("attitude", "wxyz")[samples.centres])[:, :, 2]
    with np.errstate(invalid="ignore", divide="ignore"):
        strength = np.where(pointing[:, 2] > 0.3, total[:, 2] / pointing[:, 2], np.nan)
    speed = samples.mean(samples.stack("velocity", "xyz"))
    away = [np.ones(len(speed)), *speed.T, *(speed * np.linalg.norm(speed, axis=1, keepdims=True)).T]
    for place, axis in enumerate("xy"):
        sides = np.stack([total[:, place], strength * pointing[:, place]], axis=-1)
        recorded, derived = without(sides, np.stack(away, axis=-1)).T
        name = f"the acceleration along {axis} against the tilt of the attitude"
        yield Pair(name, ("attitude", f"velocity_{axis}"), recorded, derived, _LEAST_TILT)


def without(sides: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return columns with other columns regressed out, (rows, columns); a row with a missing value stays missing."""
    known = np.isfinite(sides).all(axis=1) & np.isfinite(others).all(axis=1)
    size = np.sqrt(np.mean(others[known] ** 2, axis=0)) if known.any() else np.ones(others.shape[1])
    scaled = others[:, size > 0] / size[size > 0]
    result = np.full(sides.shape, np.nan)
    if known.sum() > scaled.shape[1]:
        found = np.linalg.lstsq(scaled[known], sides[known], rcond=1e-9)[0]
        result[known] = sides[known] - scaled[known] @ found
    return result
