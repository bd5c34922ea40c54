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

from pipeline.platforms.swerve_kinematics import lateral_matrix, lateral_matrix_rate

_SHARPNESS = 400.0
"""Of P = (1 + k·S²)⁻¹, S = L̃ᵀL̃ without unit. Its eigenvalues are the squared sines by which the wheels stand across a
motion, summed: about 2 or more across, where a part of 1/(1 + 4k) = 0.06 % passes, and 4·δ² along wheels that disagree
by δ, where 16·k·δ⁴ = 0.06 % is lost to δ = 1°."""


def rolling_projection(angle: Tensor, turning: Tensor, constants: Mapping[str, Any]) -> tuple[Tensor, Tensor]:
    """Return the projection Q of the chassis momentum [x, y, yaw] and its rate dQ/dt, (..., 3, 3) each.

    Args:
        angle: of the modules, (..., 4) rad.
        turning: rate of the angle, (..., 4) rad/s.
        constants: with `mass` kg, `inertia` kg·m² and `module_positions` (4, 2) m.
    """
    gyration = torch.as_tensor(
        constants["inertia"] / constants["mass"], dtype=angle.dtype, device=angle.device
    )
    gyration = gyration.sqrt()
    one = torch.ones_like(gyration)
    lengths = torch.stack([one, one, gyration])
    positions = constants["module_positions"]
    across = lateral_matrix(angle, positions) / lengths
    rate = lateral_matrix_rate(angle, turning, positions) / lengths
    square = across.mT @ across
    half = rate.mT @ across
    square_rate = half + half.mT
    unit = torch.eye(3, dtype=angle.dtype, device=angle.device)
    projection = torch.linalg.inv(unit + _SHARPNESS * square @ square)
    turned = square @ square_rate
    projection_rate = -_SHARPNESS * projection @ (turned + turned.mT) @ projection
    to_momentum = lengths[:, None] / lengths
    return to_momentum * projection, to_momentum * projection_rate
