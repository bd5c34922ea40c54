"""Reference motions of a joint, from informative to deliberately uninformative ones."""

from collections.abc import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d

from simgap.plants.joint.case import JointCase
from simgap.plants.rotation import Array

_LINES = 12
_LOWEST_FREQUENCY = 0.15  # Hz
_CORNER_KERNEL = 0.025  # s, standard deviation of the kernel that rounds corners
_CREEP_SHARE = 0.04  # share of the greatest velocity
_GOLDEN = (5**0.5 - 1) / 2  # spreads sizes evenly over the kinds of reference


def references(case: JointCase, times: Array, random: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration (steps, runs) within the case's limits.

    Args:
        case: references, limits and number of runs.
        times: even, (steps,) s.
        random: phases, levels and frequencies.
    """
    order = np.argsort(np.argsort([(run * _GOLDEN) % 1.0 for run in range(case.runs)]))
    sizes = np.linspace(case.gentlest, 1.0, case.runs)[order] if case.runs > 1 else np.ones(1)
    step = times[1] - times[0]
    columns = []
    for run in range(case.runs):
        name = case.references[run % len(case.references)]
        shape = SHAPES[name](case, times, random)
        velocity = np.gradient(shape, step)
        reach = np.abs(shape).max() if name != "one_way" else 0.0
        fastest = case.velocity * (_CREEP_SHARE if name == "creep" else 1.0)
        limits = (reach / case.amplitude, np.abs(velocity).max() / fastest)
        push = np.abs(np.gradient(velocity, step)).max() / case.acceleration
        columns.append(sizes[run] / max(*limits, push) * shape)
    position = np.stack(columns, axis=1)
    velocity = np.gradient(position, step, axis=0)
    return position, velocity, np.gradient(velocity, step, axis=0)


def names(case: JointCase) -> tuple[str, ...]:
    """Return the names of the runs."""
    return tuple(f"{case.references[run % len(case.references)]}_{run + 1}" for run in range(case.runs))


def _highest(case: JointCase) -> float:
    """Frequency at which velocity and acceleration reach their limits together, Hz."""
    return case.acceleration / case.velocity / (2.0 * np.pi)


def _turning(case: JointCase) -> float:
    """Frequency at which position and velocity reach their limits together, Hz."""
    return case.velocity / case.amplitude / (2.0 * np.pi)


def _multisine(case: JointCase, times: Array, random: np.random.Generator) -> Array:
    frequency = np.geomspace(_LOWEST_FREQUENCY, 1.5 * _highest(case), _LINES) * random.uniform(
        0.93, 1.07, _LINES
    )
    phase = random.uniform(0.0, 2.0 * np.pi, _LINES)
    amplitude = 1.0 / np.maximum(frequency, _turning(case))
    return (amplitude * np.sin(2.0 * np.pi * frequency * times[:, None] + phase)).sum(axis=1)


def _chirp(case: JointCase, times: Array, random: np.random.Generator) -> Array:
    low, high = 0.6 * _LOWEST_FREQUENCY, 1.5 * _highest(case) * random.uniform(0.9, 1.1)
    progress = np.clip(times / case.duration, 0.0, 1.0)
    rate = np.log(high / low)
    frequency = low * np.exp(rate * progress)
    phase = 2.0 * np.pi * case.duration * low * (np.exp(rate * progress) - 1.0) / rate
    phase += 2.0 * np.pi * low * np.minimum(times, 0.0)
    size = np.minimum(1.0, _turning(case) / frequency)
    size *= np.minimum(1.0, _highest(case) / frequency)
    return size * np.sin(phase + random.uniform(0.0, 2.0 * np.pi))


def _steps(case: JointCase, times: Array, random: np.random.Generator) -> Array:
    hold = random.uniform(0.5, 1.4, 4 + int((times[-1] - times[0]) / 0.5))
    edges = times[0] + np.cumsum(hold)
    levels = random.uniform(0.3, 1.0, len(hold) + 1) * np.resize([1.0, -1.0], len(hold) + 1)
    rounding = max(_CORNER_KERNEL, 0.4 * case.velocity / case.acceleration) / (times[1] - times[0])
    return gaussian_filter1d(levels[np.searchsorted(edges, times)], rounding, mode="nearest")


def _triangle(case: JointCase, times: Array, random: np.random.Generator) -> Array:
    period = random.uniform(0.25, 0.45) * case.duration
    return _rounded_triangle(period, times, random)


def _creep(case: JointCase, times: Array, random: np.random.Generator) -> Array:
    """Return a triangle that is followed so slowly that friction is all there is."""
    return _rounded_triangle(random.uniform(0.4, 0.6) * case.duration, times, random)


def _rounded_triangle(period: float, times: Array, random: np.random.Generator) -> Array:
    turn = times / period + random.uniform(0.0, 1.0)
    wave = 4.0 * np.abs(turn - np.floor(turn + 0.5)) - 1.0
    return gaussian_filter1d(wave, _CORNER_KERNEL / (times[1] - times[0]), mode="nearest")


def _sine(case: JointCase, times: Array, random: np.random.Generator) -> Array:
    """Return one frequency, one amplitude: little to tell causes apart by."""
    return np.sin(2.0 * np.pi * 0.6 * _turning(case) * times + random.uniform(0.0, 2.0 * np.pi))


def _one_way(case: JointCase, times: Array, random: np.random.Generator) -> Array:
    """Return motion that never turns back: dry friction then looks like a constant load."""
    swing = 2.0 * np.pi * 0.2 * random.uniform(0.8, 1.2)
    return times - 0.5 / swing * np.cos(swing * times + random.uniform(0.0, 2.0 * np.pi))


Shape = Callable[[JointCase, Array, np.random.Generator], Array]

SHAPES: dict[str, Shape] = {
    "multisine": _multisine,
    "chirp": _chirp,
    "steps": _steps,
    "triangle": _triangle,
    "creep": _creep,
    "sine": _sine,
    "one_way": _one_way,
}
"""Shapes (steps,) of any size by name."""
