"""Compiled loops of the Bouc-Wen law with exponent 1, for travels in one direction each."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST = 1000.0
"""Greatest deflection, in levels.

Where loading grows steeper, it has no end in a long motion, and has to stay finite. The limit is far beyond any
force that a recording shows: a fit would take a near one for the force at which a part yields.
"""
STEEPEST = 30.0
"""Greatest exponent of that growth: what starts at rest has passed `MOST` long before, and nothing overflows."""


@njit(cache=True)
def deflections_along(travel: Array, displacement: float, asymmetry: float) -> Array:
    """Return the deflection after each travel, step by step as in `simgap.effects.joint.hysteresis`.

    Args:
        travel: in each step, (axes, steps) rad or m.
        displacement: over which a force builds up, rad or m.
        asymmetry: of loading against unloading.

    Returns:
        deflections, which are 0 at first, (axes, steps) in levels.
    """
    loading, unloading = _rates(asymmetry)
    deflections = np.empty_like(travel)
    for axis in range(travel.shape[0]):
        deflection = 0.0
        for step in range(travel.shape[1]):
            deflection = _after(deflection, travel[axis, step] / displacement, loading, unloading)
            deflections[axis, step] = deflection
    return deflections


@njit(cache=True)
def deflections_after(deflections: Array, travel: Array, displacement: float, asymmetry: float) -> Array:
    """Return deflections after one travel each.

    Args:
        deflections: before, (axes,) in levels.
        travel: (axes,) rad or m.
        displacement: over which a force builds up, rad or m.
        asymmetry: of loading against unloading.

    Returns:
        deflections, (axes,) in levels.
    """
    loading, unloading = _rates(asymmetry)
    after = np.empty_like(travel)
    for axis in range(len(travel)):
        after[axis] = _after(deflections[axis], travel[axis] / displacement, loading, unloading)
    return after


@njit(cache=True)
def _rates(asymmetry: float) -> tuple[float, float]:
    """Return the rates of deflections that grow and that are taken back."""
    size = math.hypot(1.0 + asymmetry, asymmetry)
    return (1.0 + asymmetry) / size, (1.0 - asymmetry) / size


@njit(cache=True)
def _after(deflection: float, moved: float, loading: float, unloading: float) -> float:
    """Return a deflection after a travel in one direction, in displacements."""
    left, way = abs(moved), -1.0 if moved < 0.0 else 1.0
    along = way * deflection
    if along < 0.0:
        unwound = min(left, _to_zero(along, unloading))
        left -= unwound
        along = 0.0 if left > 0.0 else _towards(along, unloading, unwound)
    if left > 0.0:
        along = _towards(along, loading, left)
    return way * min(max(along, -MOST), MOST)


@njit(cache=True)
def _towards(along: float, rate: float, left: float) -> float:
    """Return the solution of d along = (1 − rate·along) d left."""
    exponent = max(rate * left, -STEEPEST)
    covered = left if exponent == 0.0 else -math.expm1(-exponent) / rate
    return along * math.exp(-exponent) + covered


@njit(cache=True)
def _to_zero(along: float, rate: float) -> float:
    """Return the way from a deflection below 0 to 0; infinite where it leads away from it."""
    if rate * along >= 1.0:
        return math.inf
    return -along if rate == 0.0 else math.log1p(-rate * along) / rate
