"""The classical profiles with the highest limits that a drive can follow, found by search."""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq, brute, minimize

from simgap.policies.profile.drive import Drive
from simgap.policies.profile.reference import Array, Reference, s_curve, trapezoid

_PROFILE_SAMPLES = 400
_GRID = 16
_SPAN = 30.0  # factor between the gentlest and the wildest limits that are tried

Shape = Callable[..., Reference]


def fastest_trapezoid(drive: Drive, distance: float, speed: float) -> tuple[Reference, dict[str, float]]:
    """Return the fastest trapezoid that stays within the limits of a drive, and its own limits by name.

    Args:
        drive: identified.
        distance: m.
        speed: greatest, m/s.
    """
    reference, limits = _fastest(trapezoid, drive, distance, speed, 1)
    return reference, dict(zip(("speed", "acceleration"), limits, strict=True))


def fastest_s_curve(drive: Drive, distance: float, speed: float) -> tuple[Reference, dict[str, float]]:
    """Return the fastest S-curve within the limits of a drive, and its own by name; see `fastest_trapezoid`."""
    reference, limits = _fastest(s_curve, drive, distance, speed, 2)
    return reference, dict(zip(("speed", "acceleration", "jerk"), limits, strict=True))


def peak_voltage(drive: Drive, reference: Reference) -> float:
    """Return the greatest voltage, V, that a profile asks of any wheel."""
    ends = reference.acceleration.x
    # Accelerations jump at the ends of pieces: both sides count.
    times = np.concatenate([np.linspace(0.0, ends[-1], _PROFILE_SAMPLES), ends[1:] - 1e-9])
    velocity, acceleration = reference.velocity(times), reference.acceleration(times)
    asked = _constants(drive) @ np.stack([np.ones_like(times), velocity, acceleration])
    return float(np.abs(asked).max())


def _constants(drive: Drive) -> Array:
    return np.stack([drive.static, drive.speed, drive.acceleration], axis=-1).astype(np.float64)


def _fastest(
    shape: Shape, drive: Drive, distance: float, speed: float, slopes: int
) -> tuple[Reference, list[float]]:
    """Search over the limits beyond that on speed, of which each time the highest is taken that can be followed."""
    constants = _constants(drive)
    stall = drive.voltage_limit / float(constants[:, 2].max())  # m/s²
    quickest = float((constants[:, 2] / constants[:, 1]).min())  # s
    highest = np.log([stall / quickest**order for order in range(slopes)])

    def duration(logarithms: Array) -> float:
        limits = np.exp(logarithms)
        if limits[0] > drive.acceleration_limit:
            return math.inf
        top = _highest_speed(shape, drive, distance, speed, limits)
        return shape(distance, top, *limits).duration if top > 0.0 else math.inf

    ranges = tuple(
        (high - math.log(_SPAN), high + math.log(_SPAN) * order) for order, high in enumerate(highest)
    )
    coarse = np.atleast_1d(brute(duration, ranges, Ns=_GRID, finish=None))
    limits = np.exp(
        minimize(duration, coarse, method="Nelder-Mead", options={"xatol": 1e-5, "fatol": 1e-6}).x
    )
    top = _highest_speed(shape, drive, distance, speed, limits)
    return shape(distance, top, *limits), [top, *map(float, limits)]


def _highest_speed(shape: Shape, drive: Drive, distance: float, speed: float, limits: Array) -> float:
    """Return the highest limit on speed, m/s, at which a profile can be followed; 0 where there is none."""

    def excess(top: float) -> float:
        return peak_voltage(drive, shape(distance, top, *limits)) - drive.voltage_limit

    lowest = 1e-3 * speed
    if excess(speed) <= 0.0:
        return speed
    return float(brentq(excess, lowest, speed, xtol=1e-9)) if excess(lowest) < 0.0 else 0.0
