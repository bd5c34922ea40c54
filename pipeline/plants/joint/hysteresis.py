"""Hysteresis of an elastic part (Bouc-Wen model), and the nearest law of those that a diagnosis speaks of."""

import numpy as np
from scipy.optimize import least_squares

from simgap.plants.rotation import Array

_FARTHEST = 30.0
"""Greatest displacement that is looked at, in those of the plant: along short ways both are springs."""
_ASYMMETRIES = (-0.9, 3.0)
_START = (1.0, 1.0)
"""Displacement, in those of the plant, and asymmetry: the search begins at an elastic unloading, as the plant has."""


def bouc_wen(strain: Array, travel: Array, displacement: float) -> Array:
    """Return the strain, over that at which the part yields, after a small travel.

    With exponent 2 and equal shape factors, dz = (1 − z²·(1 + sign(z·dx)) / 2)·dx / displacement: it yields more
    abruptly than a law with exponent 1 can. Exact for a travel in one direction: loading tends to ±1 as a hyperbolic
    tangent, unloading is elastic.
    Bouc 1967; Wen 1976, "Method for random vibration of hysteretic systems", equation (2).

    Args:
        strain: (runs,).
        travel: (runs,) rad or m.
        displacement: at which it would yield were it elastic till then, rad or m.
    """
    moved = travel / displacement
    way = np.sign(moved)
    along = way * strain
    unloading = np.minimum(np.maximum(-along, 0.0), np.abs(moved))
    loaded, further = np.maximum(along, 0.0), np.tanh(np.abs(moved) - unloading)
    loading = (loaded + further) / (1.0 + loaded * further)
    still = along + unloading  # 0 or less where all of the travel went into unloading
    return way * np.where(still < 0, still, loading) + np.where(way == 0, strain, 0.0)


def nearest_law(position: Array, level: float, displacement: float) -> tuple[float, float, float]:
    """Return level, displacement and asymmetry of the law that comes nearest to a `bouc_wen` along positions.

    The law is that of a diagnosis, with exponent 1: force = −level·z,
    dz = (dx − (|dx|·z + asymmetry·dx·|z|) / n) / displacement, n = hypot(1 + asymmetry, asymmetry). It is linear in the
    level.

    Args:
        position: (steps, runs) rad or m.
        level: of the plant, N·m or N.
        displacement: of the plant, rad or m.

    Returns:
        level N·m or N, displacement rad or m, asymmetry.
    """
    from simgap.physics.hysteresis_steps import deflections_along  # its import takes long

    travel = np.diff(position, axis=0)
    true = _strains(travel, displacement).T
    by_run = np.ascontiguousarray(travel.T)

    def nearest(shape: Array) -> tuple[float, Array]:
        deflections = deflections_along(by_run, displacement * np.exp(shape[0]), shape[1])
        share = float((deflections * true).sum() / (deflections * deflections).sum())
        return share, (share * deflections - true).ravel()

    longest = np.log(_FARTHEST)
    bounds = ((-longest, _ASYMMETRIES[0]), (longest, _ASYMMETRIES[1]))
    start = (np.log(_START[0]), _START[1])
    shape = least_squares(lambda each: nearest(each)[1], start, bounds=bounds).x
    return level * nearest(shape)[0], displacement * float(np.exp(shape[0])), float(shape[1])


def _strains(travel: Array, displacement: float) -> Array:
    """Return the strain after each travel, (steps, runs)."""
    strain, strains = np.zeros(travel.shape[1]), np.empty_like(travel)
    for step, each in enumerate(travel):
        strain = bouc_wen(strain, each, displacement)
        strains[step] = strain
    return strains
