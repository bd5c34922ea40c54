"""Drives that several tests look at."""

import math

import torch
from scipy.optimize import brentq

from simgap.policies.profile.drive import Drive

WHEELS = 4


def uniform(
    static: float = 0.4, speed: float = 3.78, acceleration: float = 1.06, dtype=torch.float64, **limits: float
) -> Drive:
    constants = (torch.full((WHEELS,), value, dtype=dtype) for value in (static, speed, acceleration))
    return Drive(*constants, **limits)


def bang_bang(static: float, speed: float, acceleration: float, distance: float, top: float = math.inf):
    """The exact fastest motion of the linear drive under ±12 V: full ahead, at most at the top speed, full back."""
    time_constant = acceleration / speed
    ahead, back = (12.0 - static) / speed, (12.0 + static) / speed

    def faster(v):
        time = -time_constant * math.log1p(-v / ahead)
        return time, ahead * time - time_constant * v

    def slower(v):
        time = time_constant * math.log1p(v / back)
        return time, time_constant * v - back * time

    def short(v):
        return distance - faster(v)[1] - slower(v)[1]

    limit = min(top, ahead * (1.0 - 1e-14))
    peak = brentq(short, 1e-9, limit, xtol=1e-14) if short(limit) < 0.0 else limit
    return faster(peak)[0] + slower(peak)[0] + short(peak) / peak, peak
