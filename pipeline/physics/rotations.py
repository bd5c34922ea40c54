"""Rotations as unit quaternions, scalar first, body to world (Solà 2017, arXiv 1711.02508).

Every function takes leading batch dimensions that broadcast, and is differentiable.
"""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from simgap.physics.shapes import Matrix, Quaternion, Real, Vector
from simgap.physics.tracing import may_run_compiled

_MANY = 10_000
"""Vectors from which on a compiled loop is worth its import of 0.3 s: it turns so many in 0.07 ms, tensors in 0.4."""


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product a × b."""
    a, b = torch.broadcast_tensors(a, b)
    if _suits_a_loop(a, b):
        from simgap.physics.rotation_steps import crossed

        return torch.from_numpy(crossed(_rows(a), _rows(b))).reshape(a.shape)
    return torch.linalg.cross(a, b)


def dot(a: Vector, b: Vector) -> Real:
    """Return the scalar product a · b, by its terms: a sum over three numbers at a time takes six times as long."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def rotate(quaternion: Quaternion, vector: Vector) -> Vector:
    """Turn a vector from body into world coordinates.

    Args:
        quaternion: unit attitude, body to world.
        vector: in the body frame, any unit.
    """
    if _suits_a_loop(quaternion, vector):
        return _turned(quaternion, vector, 1.0)
    axis = quaternion[..., 1:]
    twice = 2.0 * cross(axis, vector)
    return vector + quaternion[..., :1] * twice + cross(axis, twice)


def rotate_inverse(quaternion: Quaternion, vector: Vector) -> Vector:
    """Turn a vector from world into body coordinates."""
    if _suits_a_loop(quaternion, vector):
        return _turned(quaternion, vector, -1.0)
    return rotate(conjugate(quaternion), vector)


def _suits_a_loop(one: Tensor, other: Tensor) -> bool:
    """Whether there are so many numbers, and nobody asks for more, that a compiled loop is faster."""
    if max(one.numel() // one.shape[-1], other.numel() // other.shape[-1]) < _MANY:
        return False
    return one.dtype == other.dtype == torch.float64 and may_run_compiled((one, other))


def _turned(quaternion: Quaternion, vector: Vector, direction: float) -> Vector:
    from simgap.physics.rotation_steps import turned

    shape = torch.broadcast_shapes(quaternion.shape[:-1], vector.shape[:-1])
    attitude, vectors = _rows(quaternion.expand(*shape, 4)), _rows(vector.expand(*shape, 3))
    return torch.from_numpy(turned(attitude, vectors, direction)).reshape(*shape, 3)


def _rows(series: Tensor) -> NDArray[np.float64]:
    """Return series (..., components) as rows, (all, components), without a gap between them."""
    return series.reshape(-1, series.shape[-1]).contiguous().numpy()


def conjugate(quaternion: Quaternion) -> Quaternion:
    """Return the opposite rotation."""
    return torch.cat((quaternion[..., :1], -quaternion[..., 1:]), dim=-1)


def multiply(left: Quaternion, right: Quaternion) -> Quaternion:
    """Return the Hamilton product: the rotation `right` followed by `left`, both in fixed axes."""
    scalar, vector = left[..., :1], left[..., 1:]
    other_scalar, other_vector = right[..., :1], right[..., 1:]
    product = scalar * other_scalar - (vector * other_vector).sum(dim=-1, keepdim=True)
    return torch.cat(
        (product, scalar * other_vector + other_scalar * vector + cross(vector, other_vector)), dim=-1
    )


def normalize(quaternion: Quaternion) -> Quaternion:
    """Return the quaternion scaled to unit length."""
    return quaternion / torch.linalg.vector_norm(quaternion, dim=-1, keepdim=True)


def quaternion_derivative(quaternion: Quaternion, body_rate: Vector) -> Quaternion:
    """Return dq/dt = ½ q ⊗ (0, ω), 1/s.

    Args:
        quaternion: unit attitude, body to world.
        body_rate: angular velocity ω in the body frame, rad/s.
    """
    return 0.5 * multiply(quaternion, torch.cat((torch.zeros_like(body_rate[..., :1]), body_rate), dim=-1))


def to_matrix(quaternion: Quaternion) -> Matrix:
    """Return the rotation matrix, body to world, of a unit quaternion."""
    w, x, y, z = quaternion.unbind(dim=-1)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return torch.stack([torch.stack(row, dim=-1) for row in rows], dim=-2)


def from_matrix(matrix: Matrix) -> Quaternion:
    """Return the unit quaternion with w ≥ 0 of a rotation matrix (Shepperd 1978).

    Each of the four components can serve as the divisor; the largest is taken, so none is near zero.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = (row.unbind(dim=-1) for row in matrix.unbind(dim=-2))
    # Row i is 4·qᵢ·q.
    products = torch.stack(
        [
            torch.stack((1 + xx + yy + zz, zy - yz, xz - zx, yx - xy), dim=-1),
            torch.stack((zy - yz, 1 + xx - yy - zz, xy + yx, xz + zx), dim=-1),
            torch.stack((xz - zx, xy + yx, 1 - xx + yy - zz, yz + zy), dim=-1),
            torch.stack((yx - xy, xz + zx, yz + zy, 1 - xx - yy + zz), dim=-1),
        ],
        dim=-2,
    )  # (*batch, 4, 4)
    largest = torch.diagonal(products, dim1=-2, dim2=-1).argmax(dim=-1)  # (*batch,)
    index = largest[..., None, None].expand(*largest.shape, 1, 4)
    return _positive(normalize(products.gather(-2, index).squeeze(-2)))


def from_rotation_vector(vector: Vector) -> Quaternion:
    """Return the unit quaternion of a rotation vector (axis times angle, rad)."""
    half = 0.5 * torch.linalg.vector_norm(vector, dim=-1, keepdim=True)
    return torch.cat((torch.cos(half), 0.5 * vector * torch.sinc(half / torch.pi)), dim=-1)


def to_rotation_vector(quaternion: Quaternion) -> Vector:
    """Return the rotation vector (axis times angle, rad) of least length, angle at most π."""
    quaternion = _positive(quaternion)
    scalar, vector = quaternion[..., :1], quaternion[..., 1:]
    length = torch.linalg.vector_norm(vector, dim=-1, keepdim=True)
    small = length < 1e-7  # there atan2(length, w) / length has its limit 1 / w
    safe = torch.where(small, torch.ones_like(length), length)
    safe_scalar = torch.where(small, scalar, torch.ones_like(scalar))
    return vector * torch.where(small, 2.0 / safe_scalar, 2.0 * torch.atan2(safe, scalar) / safe)


def rotation_angle(first: Quaternion, second: Quaternion) -> Real:
    """Return the angle between two attitudes, rad, from 0 to π."""
    difference = multiply(conjugate(first), second)
    return 2.0 * torch.atan2(
        torch.linalg.vector_norm(difference[..., 1:], dim=-1), torch.abs(difference[..., 0])
    )


def _positive(quaternion: Quaternion) -> Quaternion:
    return torch.where(quaternion[..., :1] < 0, -quaternion, quaternion)
