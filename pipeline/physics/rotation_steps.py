"""Compiled rotations of many vectors: one pass over their numbers, where tensors would take one for each product.

Numbers are taken one by one: to unpack a row takes as long as all the rest.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True)
def crossed(first: Array, second: Array) -> Array:
    """Return the vector products of vectors, (vectors, 3)."""
    found = np.empty(first.shape)
    for place in range(len(first)):
        a, b, c = first[place, 0], first[place, 1], first[place, 2]
        x, y, z = second[place, 0], second[place, 1], second[place, 2]
        found[place, 0] = b * z - c * y
        found[place, 1] = c * x - a * z
        found[place, 2] = a * y - b * x
    return found


@njit(cache=True)
def turned(attitude: Array, vectors: Array, direction: float) -> Array:
    """Return vectors turned by unit quaternions.

    Args:
        attitude: scalar first, (vectors, 4).
        vectors: (vectors, 3).
        direction: 1 to turn them, -1 to turn them back.
    """
    found = np.empty(vectors.shape)
    for place in range(len(vectors)):
        scalar = attitude[place, 0]
        x, y, z = (
            direction * attitude[place, 1],
            direction * attitude[place, 2],
            direction * attitude[place, 3],
        )
        a, b, c = vectors[place, 0], vectors[place, 1], vectors[place, 2]
        p, q, r = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
        found[place, 0] = a + scalar * p + y * r - z * q
        found[place, 1] = b + scalar * q + z * p - x * r
        found[place, 2] = c + scalar * r + x * q - y * p
    return found
