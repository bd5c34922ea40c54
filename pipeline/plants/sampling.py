"""Sampling of true signals by a logger."""

import numpy as np
from numpy.typing import NDArray

from simgap.plants.rotation import Array


def at(series: Array, times: Array, step: float, before: float) -> Array:
    """Interpolate a log (steps, ...) that begins at `-before` at times (samples,), s; its ends are held."""
    place = np.clip((times + before) / step, 0.0, len(series) - 1.0)
    below = np.minimum(np.floor(place + 1e-9).astype(int), len(series) - 2)
    share = np.maximum(place - below, 0.0).reshape(-1, *[1] * (series.ndim - 1))
    return series[below] * (1.0 - share) + series[below + 1] * share


def held_at(series: Array, times: Array, step: float, before: float) -> Array:
    """Return the value that was valid at times (samples,), s, of a log (steps, ...) that changes in jumps."""
    place = np.floor((times + before) / step + 1e-6).astype(int)
    return series[np.clip(place, 0, len(series) - 1)]


def quantised(values: Array, step: float) -> Array:
    """Return values as whole numbers of steps; unchanged for a step of 0."""
    return np.round(values / step) * step if step > 0 else values


def instants(samples: int, rate: float, jitter: float, random: np.random.Generator) -> Array:
    """Return the instants (samples,), s, at which a logger samples; the first is 0."""
    grid = np.arange(samples) / rate
    return grid + jitter * np.clip(random.standard_normal(samples), -2.5, 2.5) * (grid > 0)


def kept(samples: int, dropped: float, random: np.random.Generator) -> NDArray[np.bool_]:
    """Mark the samples that are not lost; the first and the last never are."""
    remaining = random.random(samples) >= dropped
    remaining[[0, -1]] = True
    return remaining
