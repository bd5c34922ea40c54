"""Nonholonomic constraint of a swerve drive: forces on the chassis under rolling without side slip.

Each wheel rolls without side slip: L(angles)·twist = 0, one row per module. The side forces do no work. In coordinates
with a unit mass matrix they are orthogonal to every allowed motion, and a projection removes them:

    free chassis with side forces   M (dV/dt + transport) = F + Lᵀλ,   L V = 0
    without them                    dp/dt = Q (F − M·transport) + (dQ/dt) p,   p = M V

Source: Udwadia & Kalaba 1992, A new perspective on constrained motion (Proc. R. Soc. A 439), with the projector made
smooth: wheels that disagree lock the chassis bit by bit, and wheels that disagree by sensor noise do not.
"""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from simgap.physics.latest import Latest
from simgap.physics.shapes import Matrix, PerModule, Vector
from simgap.platforms.swerve_kinematics import lateral_matrix, lateral_matrix_rate, rolling_speed

_SHARPNESS = 400.0
"""Of P = (1 + k·S⁴)⁻¹, S = L̃ᵀL̃ without unit. Its eigenvalues are the squared sines by which the wheels stand across a
motion, summed: 1 or more across, where a part of 1/(1 + k) = 0.25 % passes at most, and 4·δ² along wheels that disagree
by δ, where 256·k·δ⁸ = 0.1 % is lost to δ = 6°. Such wheels drag, which is a matter of their side forces. With S² more
was lost to 2°, and misaligned wheels took another motor constant."""

# Added to the eigenvalues of S, which may be 0: wheels that disagree by 1.4° or 0.3° stand as much across.
_BLUR, _FLOOR = 2.5e-3, 1e-4  # for a drift; for the motion that wheels allow

_PROJECTIONS, _MOTIONS = Latest[tuple[Matrix, Matrix]](), Latest[Vector]()
"""Most candidates of a fit change neither the wheels' angles nor the chassis."""


def rolling_projection(
    angle: PerModule, turning: PerModule, constants: Mapping[str, Any]
) -> tuple[Matrix, Matrix]:
    """Return the projection Q of the chassis momentum [x, y, yaw] and its rate dQ/dt, (..., 3, 3) each.

    Inside, the indices of matrices come first: a product is then a few operations over all samples, far faster than a
    small matrix product at each.

    Args:
        angle: of the modules, (..., 4) rad.
        turning: rate of the angle, (..., 4) rad/s.
        constants: with `mass` kg, `inertia` kg·m² and `module_positions` (4, 2) m.
    """
    lengths, positions = _lengths(angle.double(), constants), constants["module_positions"]
    given = angle, turning, lengths, positions
    return _PROJECTIONS.of(given, lambda: _rolling_projection(*given))


def _rolling_projection(
    angle: PerModule, turning: PerModule, lengths: Tensor, positions: Tensor
) -> tuple[Matrix, Matrix]:
    dtype, angle, turning = angle.dtype, angle.double(), turning.double()  # k costs single precision 4 digits
    across = _indices_first(lateral_matrix(angle, positions) / lengths)
    rate = _indices_first(lateral_matrix_rate(angle, turning, positions) / lengths)
    square, half = _product(across.transpose(0, 1), across), _product(rate.transpose(0, 1), across)
    squared = _product(square, square)
    turned = _rate_of_square(square, half + half.transpose(0, 1))
    turned = _rate_of_square(squared, turned)
    projection = _inverse_beside_fourth(square, squared)
    changed = _product(projection, _product(turned, projection))
    to_momentum = lengths[:, None] / lengths
    found = projection, -_SHARPNESS * changed
    both = [to_momentum * matrix.movedim((0, 1), (-2, -1)) for matrix in found]
    return both[0].to(dtype), both[1].to(dtype)


def along_the_wheels(twist: Vector, angle: PerModule, constants: Mapping[str, Any]) -> Vector:
    """Return the component of a twist that side slip hinders least, (..., 3).

    Measured wheel angles never agree exactly. Side forces of equally loaded tyres grow with slip angles (Pacejka 2012,
    Tire and vehicle dynamics, §1.2), so side slip hinders least the eigenvector of the least eigenvalue of S, with the
    rows of L̃ over the square root of each wheel's rolling speed. One step of inverse iteration leads there from a
    measured twist.

    Args:
        twist: measured, (..., 3).
        angle: of the wheels, (..., 4) rad.
        constants: with `mass` kg, `inertia` kg·m², `module_positions` (4, 2) m and `creep` m/s, below which side forces
            grow with slip speeds.
    """
    creep = torch.as_tensor(constants["creep"], dtype=angle.dtype, device=angle.device)
    given = twist, angle, _lengths(angle, constants), constants["module_positions"], creep
    return _MOTIONS.of(given, lambda: _along_the_wheels(*given))


def _along_the_wheels(
    twist: Vector, angle: PerModule, lengths: Tensor, positions: Tensor, creep: Tensor
) -> Vector:
    scaled = twist * lengths
    grip = torch.hypot(rolling_speed(twist, angle, positions), creep).rsqrt()
    grip = grip / grip.square().mean(-1, keepdim=True).sqrt()
    across = _indices_first(grip[..., None] * lateral_matrix(angle, positions) / lengths)
    square = _product(across.transpose(0, 1), across)
    easy = _inverse(_unit_matrix(square) * _FLOOR + square) * scaled.movedim(-1, 0)
    easy = easy.sum(1).movedim(0, -1)
    easy = easy / easy.norm(dim=-1, keepdim=True).clamp_min(1e-12)
    return easy * (easy * scaled).sum(-1, keepdim=True) / lengths


def twist_across(speed: PerModule, angle: PerModule, constants: Mapping[str, Any]) -> Vector:
    """Return the twist at which the wheels move across themselves at given speeds, nearest to them, (..., 3).

    What the wheels allow is left out: it moves none of them across.

    Args:
        speed: of each wheel to its left, (..., 4) m/s.
        angle: of the wheels, (..., 4) rad.
        constants: with `mass` kg, `inertia` kg·m² and `module_positions` (4, 2) m.
    """
    lengths = _lengths(angle, constants)
    across = _indices_first(lateral_matrix(angle, constants["module_positions"]) / lengths)
    square = _product(across.transpose(0, 1), across)
    pushed = (across * speed.movedim(-1, 0)[:, None]).sum(0)
    twist = (_inverse(_unit_matrix(square) * _BLUR + square) * pushed).sum(1)
    return twist.movedim(0, -1) / lengths


def _lengths(angle: Tensor, constants: Mapping[str, Any]) -> Tensor:
    """Return what makes the components of a twist speeds: 1, 1 and the radius of gyration, m, (3,)."""
    ratio = constants["inertia"] / constants["mass"]
    gyration = torch.as_tensor(ratio, dtype=angle.dtype, device=angle.device).sqrt()
    return torch.stack([torch.ones_like(gyration), torch.ones_like(gyration), gyration])


def _unit_matrix(matrix: Tensor) -> Tensor:
    """Return the unit matrix in the shape of matrices (3, 3, ...)."""
    unit = torch.eye(3, dtype=matrix.dtype, device=matrix.device)
    return unit.reshape(3, 3, *[1] * (matrix.ndim - 2))


def _indices_first(matrix: Tensor) -> Tensor:
    """Return matrices (..., rows, columns) with their indices first."""
    return matrix.movedim((-2, -1), (0, 1)).contiguous()


def _inverse_beside_fourth(matrix: Tensor, squared: Tensor) -> Tensor:
    """Return (1 + k·S⁴)⁻¹ of symmetric matrices S (3, 3, ...) with their squares.

    By its factors 1 ± √(2√k)·S + √k·S², of which each loses half as many digits as the whole.
    """
    root = _SHARPNESS**0.5
    even, odd = _unit_matrix(matrix) + root * squared, (2.0 * root) ** 0.5 * matrix
    return _product(_inverse(even + odd), _inverse(even - odd))


def _rate_of_square(matrix: Tensor, rate: Tensor) -> Tensor:
    """Return the rate of the squares of symmetric matrices (3, 3, ...) that change at a rate."""
    half = _product(matrix, rate)
    return half + half.transpose(0, 1)


def _product(first: Tensor, second: Tensor) -> Tensor:
    """Return the product of matrices (rows, inner, ...) and (inner, columns, ...), (rows, columns, ...)."""
    return (first[:, :, None] * second[None]).sum(1)


def _inverse(matrix: Tensor) -> Tensor:
    """Return the inverse of symmetric positive matrices (3, 3, ...) from their factors L·D·Lᵀ."""
    a, b, c, d, e, f = matrix[0, 0], matrix[0, 1], matrix[0, 2], matrix[1, 1], matrix[1, 2], matrix[2, 2]
    second, third = b / a, c / a
    middle, mixed = d - second * b, e - third * b
    last = mixed / middle
    first = second * last - third
    inner, outer = 1.0 / middle, 1.0 / (f - third * c - last * mixed)
    corner, edge, side = first * outer, -last * outer, -second * inner - first * last * outer
    top = 1.0 / a + second * second * inner + first * corner
    rows = [top, side, corner, side, inner + last * last * outer, edge, corner, edge, outer]
    return torch.stack(rows).unflatten(0, (3, 3))
