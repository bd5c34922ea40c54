"""Reference motion of a swerve drive: a twist of varying size and slowly turning direction."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from simgap.plants.rotation import Array
from simgap.plants.swerve.arena import laps
from simgap.plants.swerve.case import SwerveCase
from simgap.platforms import Swerve

_GOLDEN = (5**0.5 - 1) / 2  # spreads sizes evenly over the manoeuvres
_LINES = 5
_CORNER_KERNEL = 0.1  # s, standard deviation of the kernel that rounds changes of speed
_YAW_SHARE = 0.6  # of a module's speed that comes from yaw where the robot translates
_SHIFT_SHARE = 0.5  # of a module's speed that comes from translation where the robot spins


@dataclass(frozen=True)
class Reference:
    """Setpoints of the modules, (steps, runs, 4) each.

    Attributes:
        angle: of the modules, rad, never turned over at a stop.
        rate: its rate, rad/s.
        acceleration: of the angle, rad/s².
        speed: of the wheels, m/s.
        pace: rate of the speed, m/s².
    """

    angle: Array
    rate: Array
    acceleration: Array
    speed: Array
    pace: Array


def references(case: SwerveCase, platform: Swerve, times: Array, random: np.random.Generator) -> Reference:
    """Return references of all runs within the case's limits on speed, acceleration and rates.

    A run's twist is a size that swings through zero times a direction that turns without haste, so that all modules
    roll on without turning over.
    """
    order = np.argsort(np.argsort([(run * _GOLDEN) % 1.0 for run in range(case.runs)]))
    sizes = np.linspace(case.gentlest, 1.0, case.runs)[order] if case.runs > 1 else np.ones(1)
    modules = np.array(platform.module_positions)
    angles, speeds = [], []
    for run in range(case.runs):
        name = case.manoeuvres[run % len(case.manoeuvres)]
        if name == "arena":
            angle, speed, yaw = laps(case, modules, times, random)
        else:
            direction = _direction(name, case, modules, times, random)
            angle, speed, yaw = _modules(direction, _swing(name, case, times, random), modules)
        step = times[1] - times[0]
        limits = (
            np.abs(speed).max() / case.speed,
            np.abs(np.gradient(speed, step, axis=0)).max() / case.acceleration,
            np.abs(yaw).max() / case.yaw_rate,
        )
        angles.append(angle)
        speeds.append(sizes[run] / max(limits) * speed)
    angle, speed = np.stack(angles, axis=1), np.stack(speeds, axis=1)
    step = times[1] - times[0]
    rate = np.gradient(angle, step, axis=0)
    return Reference(angle, rate, np.gradient(rate, step, axis=0), speed, np.gradient(speed, step, axis=0))


def names(case: SwerveCase) -> tuple[str, ...]:
    """Return the names of the runs."""
    return tuple(f"{case.manoeuvres[run % len(case.manoeuvres)]}_{run + 1}" for run in range(case.runs))


def _modules(direction: Array, swing: Array, modules: Array) -> tuple[Array, Array, Array]:
    """Return angles and speeds of the modules (steps, 4) and the yaw rate (steps,)."""
    x = direction[:, :1] - direction[:, 2:] * modules[:, 1]
    y = direction[:, 1:2] + direction[:, 2:] * modules[:, 0]
    return np.unwrap(np.arctan2(y, x), axis=0), np.hypot(x, y) * swing[:, None], direction[:, 2] * swing


def _direction(
    name: str, case: SwerveCase, modules: Array, times: Array, random: np.random.Generator
) -> Array:
    """Return the direction of the twist (steps, 3): 1 m/s at the centre, or at the modules for `spin`."""
    reach = np.hypot(*modules.T).max()
    heading = np.full_like(times, random.uniform(-np.pi, np.pi) if name != "straight" else 0.0)
    turning = np.zeros_like(times)
    if name in ("weave", "spin"):
        heading = heading + _waves(times, random, 0.6 * case.steering_rate)
    if name in ("weave", "curve"):
        turning = turning + _waves(times, random, 1.0) + random.uniform(-0.5, 0.5)
    turning = _YAW_SHARE / reach * np.clip(turning, -1.0, 1.0)
    share = 1.0
    if name == "spin":
        share, turning = _SHIFT_SHARE, np.full_like(times, 1.0 / reach)
    direction = np.stack((share * np.cos(heading), share * np.sin(heading), turning), axis=1)
    return gaussian_filter1d(direction, _CORNER_KERNEL / (times[1] - times[0]), axis=0, mode="nearest")


def _waves(times: Array, random: np.random.Generator, slope: float) -> Array:
    """Return a sum of sines with that greatest slope, per second."""
    frequency = 2.0 * np.pi * np.geomspace(0.12, 1.6, _LINES) * random.uniform(0.9, 1.1, _LINES)
    phase = random.uniform(0.0, 2.0 * np.pi, _LINES)
    argument = frequency * times[:, None] + phase
    wave = (np.sin(argument) / np.sqrt(frequency)).sum(axis=1)
    return slope / np.abs((np.sqrt(frequency) * np.cos(argument)).sum(axis=1)).max() * wave


def _swing(name: str, case: SwerveCase, times: Array, random: np.random.Generator) -> Array:
    """Return how the size of the twist changes (steps,), of any scale."""
    if name == "cruise":
        return 1.0 + 0.05 * np.sin(0.5 * times + random.uniform(0.0, 2.0 * np.pi))
    frequency = 2.0 * np.pi * np.geomspace(0.1, 1.2, _LINES) * random.uniform(0.9, 1.1, _LINES)
    phase = random.uniform(0.0, 2.0 * np.pi, _LINES)
    wave = (np.sin(frequency * times[:, None] + phase) / frequency**0.7).sum(axis=1)
    edges = times[0] + np.cumsum(random.uniform(0.6, 1.6, 4 + int((times[-1] - times[0]) / 0.6)))
    levels = random.uniform(-1.0, 1.0, len(edges) + 1)
    steps = gaussian_filter1d(
        levels[np.searchsorted(edges, times)], _CORNER_KERNEL / (times[1] - times[0]), mode="nearest"
    )
    return wave / np.abs(wave).max() + 0.7 * steps
