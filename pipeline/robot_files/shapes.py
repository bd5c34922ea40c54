"""Volume and inertia of homogeneous shapes about their centre.

Meriam & Kraige, Engineering Mechanics: Dynamics, table D/4.
"""

import math
from collections.abc import Callable

import numpy as np

SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}
"""How many sizes each shape of MJCF has."""


def solid_of(shape: str, size: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the volume, m³, and the inertia of a unit density, m⁵, shape (3, 3), of a shape of MJCF.

    Args:
        shape: one of `SIZES`; its long axis is z.
        size: radius; radius and half length (of the cylindrical part of a capsule); half sides; or semi-axes; m.
    """
    volume, moments = _OF[shape](*size[: SIZES[shape]])
    return volume, np.diag(moments)


def _ellipsoid(a: float, b: float, c: float) -> tuple[float, list[float]]:
    volume = 4.0 / 3.0 * math.pi * a * b * c
    return volume, [
        volume * (b * b + c * c) / 5.0,
        volume * (a * a + c * c) / 5.0,
        volume * (a * a + b * b) / 5.0,
    ]


def _box(a: float, b: float, c: float) -> tuple[float, list[float]]:
    volume = 8.0 * a * b * c
    return volume, [
        volume * (b * b + c * c) / 3.0,
        volume * (a * a + c * c) / 3.0,
        volume * (a * a + b * b) / 3.0,
    ]


def _cylinder(radius: float, half: float) -> tuple[float, list[float]]:
    volume = 2.0 * math.pi * radius**2 * half
    across = volume * (radius**2 / 4.0 + half**2 / 3.0)
    return volume, [across, across, volume * radius**2 / 2.0]


def _capsule(radius: float, half: float) -> tuple[float, list[float]]:
    """Two half spheres, whose centres of mass lie 3/8 of the radius beyond the ends of the cylinder."""
    volume, (across, _, along) = _cylinder(radius, half)
    ends = 4.0 / 3.0 * math.pi * radius**3
    across += ends * (0.4 * radius**2 + half**2 + 0.75 * radius * half)
    return volume + ends, [across, across, along + ends * 0.4 * radius**2]


_OF: dict[str, Callable[..., tuple[float, list[float]]]] = {
    "sphere": lambda radius: _ellipsoid(radius, radius, radius),
    "capsule": _capsule,
    "cylinder": _cylinder,
    "box": _box,
    "ellipsoid": _ellipsoid,
}
