"""Air that moves: a steady wind, and gusts as they come.

Gusts follow the first-order forming filter of the Dryden spectrum (MIL-F-8785C, longitudinal component) on every
axis, their intensity upwards being half of that along the ground.
"""

import itertools
import math

import numpy as np

from simgap.plants.case import PlantCase
from simgap.plants.rotation import Array

_CORRELATION_TIME = 1.5  # s
_UPWARDS = np.array([1.0, 1.0, 0.5])


def wind_along(case: PlantCase, steps: int, step: float, random: np.random.Generator) -> Array | None:
    """Return the wind (steps, runs, 3), world frame, m/s; None where the air is still.

    Args:
        case: speed of the steady wind and of the gusts.
        steps: how many.
        step: s.
        random: for the gusts.
    """
    steady = np.array([*(case.strength("steady_wind", f"wind_{axis}") for axis in "xy"), 0.0])
    gusts = case.strength("gusts")
    if gusts == 0 and not steady.any():
        return None
    wind = np.broadcast_to(steady, (steps, case.runs, 3)).copy()
    if gusts > 0:
        wind += gusts * _UPWARDS * first_order_noise((steps, case.runs, 3), step / _CORRELATION_TIME, random)
    return wind


def first_order_noise(shape: tuple[int, ...], step: float, random: np.random.Generator) -> Array:
    """Return a Gauss–Markov process of unit variance along the first axis; `step` is in correlation times."""
    keep = math.exp(-step)
    noise = random.standard_normal(shape)
    noise[1:] *= math.sqrt(1.0 - keep * keep)
    for before, now in itertools.pairwise(noise):
        now += keep * before
    return noise
