"""Hysteresis of an elastic part (Bouc-Wen and Dahl models)."""

import numpy as np

from simgap.plants.rotation import Array


def bouc_wen(strain: Array, travel: Array, displacement: float) -> Array:
    """Return the strain, over that at which the part yields, after a small travel.

    With exponent 1 and equal shape factors, dz = (1 − |z|·(1 + sign(z·dx)) / 2)·dx / displacement. Exact for a travel
    in one direction: loading tends to ±1 exponentially, unloading is elastic.
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
    loaded = np.maximum(along, 0.0)
    loading = 1.0 - (1.0 - loaded) * np.exp(unloading - np.abs(moved))
    still = along + unloading  # 0 or less where all of the travel went into unloading
    return way * np.where(still < 0, still, loading) + np.where(way == 0, strain, 0.0)


def dahl(strain: Array, travel: Array, displacement: Array | float) -> Array:
    """Return the strain after a travel in one direction, by the law of which a diagnosis speaks.

    Dahl 1976, "Solid friction damping of mechanical vibrations", equation (6) with exponent 1.

    Args:
        strain: (..., runs).
        travel: (..., runs) rad or m.
        displacement: over which it builds up, rad or m.
    """
    way = np.sign(travel)
    return way + (strain - way) * np.exp(-np.abs(travel) / displacement)


def nearest_dahl(position: Array, level: float, displacement: float) -> tuple[float, float]:
    """Return level and displacement of the `dahl` that comes nearest to a `bouc_wen` along positions (steps, runs)."""
    candidates = displacement * np.geomspace(0.5, 3.0, 61)
    true = np.zeros(position.shape[1])
    law = np.zeros((len(candidates), position.shape[1]))
    cross, square, energy = np.zeros(len(candidates)), np.zeros(len(candidates)), 0.0
    for travel in np.diff(position, axis=0):
        true, law = bouc_wen(true, travel, displacement), dahl(law, travel, candidates[:, None])
        cross += law @ true
        square += (law * law).sum(axis=1)
        energy += float(true @ true)
    best = int(np.argmin(energy - cross * cross / square))
    return level * float(cross[best] / square[best]), float(candidates[best])
