"""Rotations of the plants in NumPy, because tensors are too slow at 1 kHz.

Quaternions scalar first, body to world. Kept apart from `simgap.physics`, lest errors be shared.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def matrix(quaternion: Array) -> Array:
    """Return rotation matrices (..., 3, 3), body to world, of unit quaternions (..., 4)."""
    w, x, y, z = (quaternion[..., i] for i in range(4))
    result = np.empty((*quaternion.shape[:-1], 3, 3))
    result[..., 0, 0] = 1 - 2 * (y * y + z * z)
    result[..., 0, 1] = 2 * (x * y - w * z)
    result[..., 0, 2] = 2 * (x * z + w * y)
    result[..., 1, 0] = 2 * (x * y + w * z)
    result[..., 1, 1] = 1 - 2 * (x * x + z * z)
    result[..., 1, 2] = 2 * (y * z - w * x)
    result[..., 2, 0] = 2 * (x * z - w * y)
    result[..., 2, 1] = 2 * (y * z + w * x)
    result[..., 2, 2] = 1 - 2 * (x * x + y * y)
    return result


def product(left: Array, right: Array) -> Array:
    """Return the Hamilton product of quaternions (..., 4)."""
    w, x, y, z = (left[..., i] for i in range(4))
    a, b, c, d = (right[..., i] for i in range(4))
    return np.stack(
        (
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ),
        axis=-1,
    )


def from_small_angles(angles: Array) -> Array:
    """Return the quaternions (..., 4) of rotation vectors (..., 3), rad."""
    half = 0.5 * np.linalg.norm(angles, axis=-1, keepdims=True)
    return np.concatenate((np.cos(half), 0.5 * angles * np.sinc(half / np.pi)), axis=-1)


def cross(a: Array, b: Array) -> Array:
    """Return the vector product of (..., 3); numpy's own costs ten times as much on small arrays."""
    result = np.empty(np.broadcast(a, b).shape)
    result[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    result[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    result[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return result
