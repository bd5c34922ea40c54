"""Baselines of a policy: the classical profiles and the time-optimal bound."""

import math
from dataclasses import replace

import numpy as np

from simgap.policies.profile.drive import Drive
from simgap.policies.profile.motion import Motion, drive_along
from simgap.policies.profile.reference import Reference, trapezoid
from simgap.policies.profile.rivals import fastest_s_curve, fastest_trapezoid
from simgap.policies.profile.settings import Profile
from simgap.policies.profile.time_optimal import time_optimal

PUBLISHED = "published_trapezoid"
TRAPEZOID, S_CURVE = "fastest_trapezoid", "fastest_s_curve"
BOUND, VOLTAGE_BOUND = "time_optimal", "time_optimal_by_voltage"
POLICY = "policy"

_REST = 0.1  # s that the drive is watched after the end of a profile


def classical(task: Profile, drive: Drive) -> dict[str, Motion]:
    """Return what the drive does when it follows the classical profiles, by name.

    The published one has a speed of 3 m/s and an acceleration of 2 m/s²; the others have the highest limits at which
    they can be followed.
    """
    distance, top = task.distance, task.speed_limit
    references = {
        PUBLISHED: trapezoid(distance, 3.0, 2.0),
        TRAPEZOID: fastest_trapezoid(drive, distance, top)[0],
        S_CURVE: fastest_s_curve(drive, distance, top)[0],
    }
    return {name: _followed(reference, task, drive) for name, reference in references.items()}


def bounds(task: Profile, drive: Drive) -> dict[str, Motion]:
    """Return the fastest motions there are, by name: within all limits, and within that of the voltage alone."""
    unlimited = replace(drive, acceleration_limit=math.inf)
    return {
        BOUND: time_optimal(drive, task.distance, task.speed_limit),
        VOLTAGE_BOUND: time_optimal(unlimited, task.distance),
    }


def _followed(reference: Reference, task: Profile, drive: Drive) -> Motion:
    steps = math.ceil((reference.duration + _REST) / task.period)
    ends = task.period * np.arange(1, steps + 1, dtype=np.float64)
    return drive_along(drive, reference.velocities(ends), task.period)


def measures(motion: Motion, task: Profile) -> dict[str, float]:
    """Return the measures of a motion: time to the target, end position and voltage.

    `time` in s, NaN where it never does, `miss` at the end in m, `peak_voltage` in V, `mean_square_voltage` in V² while
    it lasts.
    """
    time = motion.arrival(task.distance, task.tolerance, task.speed_tolerance)
    lasting = motion.voltage[~(motion.time[:-1] >= time)]
    return {
        "time": time,
        "miss": float(abs(motion.position[-1] - task.distance)),
        "peak_voltage": float(np.abs(motion.voltage).max()),
        "mean_square_voltage": float(np.mean(lasting**2)),
    }
