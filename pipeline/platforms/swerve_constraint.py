"""What rolling without side slip leaves of the forces on a swerve drive's chassis.

Each wheel rolls but does not slide across: L(angles)·twist = 0, one row per module. The side forces that see to it do
no work, so in coordinates that make the mass a unit matrix they are at right angles to every motion that is allowed,
and a projection takes them out:

    free chassis with side forces   M (dV/dt + transport) = F + Lᵀλ,   L V = 0
    without them                    dp/dt = Q (F − M·transport) + (dQ/dt) p,   p = M V

Source: Udwadia & Kalaba 1992, A new perspective on constrained motion (Proc. R. Soc. A 439), with the projector made
smooth: wheels that disagree lock the chassis bit by bit, and wheels that disagree by sensor noise do not.
"""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

_SHARPNESS = 400.0
"""Of P = (1 + k·S²)⁻¹, S = L̃ᵀL̃ without unit. Its eigenvalues are the squared sines by which the wheels stand across a
motion, summed: about 2 or more across, where a part of 1/(1 + 4k) = 0.06 % passes, and 4·δ² along wheels that disagree
by δ, where 16·k·δ⁴ = 0.06 % is lost to δ = 1°."""


Matrix = list[list[Tensor]]
"""Rows of entries, each over the samples: far faster than a small matrix at every sample."""


def rolling_projection(angle: Tensor, turning: Tensor, constants: Mapping[str, Any]) -> tuple[Tensor, Tensor]:
    """Return the projection Q of the chassis momentum [x, y, yaw] and its rate dQ/dt, (..., 3, 3) each.

    Args:
        angle: of the modules, (..., 4) rad.
        turning: rate of the angle, (..., 4) rad/s.
        constants: with `mass` kg, `inertia` kg·m² and `module_positions` (4, 2) m.
    """
    dtype, (angle, turning) = (
        angle.dtype,
        (angle.double(), turning.double()),
    )  # k costs single precision 4 digits
    ratio = constants["inertia"] / constants["mass"]
    gyration = torch.as_tensor(ratio, dtype=angle.dtype, device=angle.device).sqrt()
    across, rate = _lateral(angle, turning, constants["module_positions"].to(angle), gyration)
    square = _product(_transposed(across), across)
    half = _product(_transposed(rate), across)
    turned = _product(square, _sum(half, _transposed(half)))
    projection = _inverse(_one_plus(_product(square, square), _SHARPNESS))
    changed = _product(projection, _product(_sum(turned, _transposed(turned)), projection))
    one = torch.ones_like(gyration)
    lengths = torch.stack([one, one, gyration])
    to_momentum = lengths[:, None] / lengths
    changed_momentum = -_SHARPNESS * to_momentum * _stacked(changed)
    return (to_momentum * _stacked(projection)).to(dtype), changed_momentum.to(dtype)


def _lateral(angle: Tensor, turning: Tensor, positions: Tensor, gyration: Tensor) -> tuple[Matrix, Matrix]:
    """Return `lateral_matrix` and its rate in coordinates without unit, a row per module."""
    across, rate = [], []
    sines, cosines = torch.sin(angle).unbind(-1), torch.cos(angle).unbind(-1)
    for sine, cosine, turn, (x, y) in zip(sines, cosines, turning.unbind(-1), positions, strict=True):
        across.append([-sine, cosine, (sine * y + cosine * x) / gyration])
        rate.append([-turn * cosine, -turn * sine, turn * (cosine * y - sine * x) / gyration])
    return across, rate


def _product(first: Matrix, second: Matrix) -> Matrix:
    columns = _transposed(second)
    return [[_dot(row, column) for column in columns] for row in first]


def _dot(first: list[Tensor], second: list[Tensor]) -> Tensor:
    total = first[0] * second[0]
    for one, other in zip(first[1:], second[1:], strict=True):
        total = torch.addcmul(total, one, other)
    return total


def _sum(first: Matrix, second: Matrix) -> Matrix:
    return [[a + b for a, b in zip(*rows, strict=True)] for rows in zip(first, second, strict=True)]


def _transposed(matrix: Matrix) -> Matrix:
    return [list(column) for column in zip(*matrix, strict=True)]


def _one_plus(matrix: Matrix, factor: float) -> Matrix:
    return [[factor * entry + (i == j) for j, entry in enumerate(row)] for i, row in enumerate(matrix)]


def _inverse(matrix: Matrix) -> Matrix:
    """Return the inverse of a symmetric positive matrix from its factors L·D·Lᵀ."""
    (a, b, c), (_, d, e), (_, _, f) = matrix
    second, third = b / a, c / a
    middle, mixed = d - second * b, e - third * b
    last = mixed / middle
    first = second * last - third
    inner, outer = 1.0 / middle, 1.0 / (f - third * c - last * mixed)
    corner, edge, side = first * outer, -last * outer, -second * inner - first * last * outer
    return [
        [1.0 / a + second * second * inner + first * corner, side, corner],
        [side, inner + last * last * outer, edge],
        [corner, edge, outer],
    ]


def _stacked(matrix: Matrix) -> Tensor:
    return torch.stack([torch.stack(row, dim=-1) for row in matrix], dim=-2)
