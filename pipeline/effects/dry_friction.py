"""Dry friction that also holds still, shared by joints, wheels and steered modules."""

import torch
from torch import Tensor


def dry_friction(
    level: Tensor | float, velocity: Tensor, applied: Tensor, sliding_velocity: Tensor | float
) -> Tensor:
    """Friction that opposes motion at its level, and at standstill whatever is applied, up to its level (...,).

    Below the velocity that the recording can tell from zero the one passes smoothly into the other.
    Source: Karnopp 1985, Computer simulation of stick-slip friction (ASME J. Dyn. Syst. 107).

    Args:
        level: N·m or N.
        velocity: (...,) rad/s or m/s.
        applied: what else acts, (...,) in the unit of the level.
        sliding_velocity: in the unit of the velocity; far above it the axis slides.
    """
    slip = torch.tanh(velocity / sliding_velocity)
    level = torch.as_tensor(level, dtype=slip.dtype)
    held = torch.maximum(torch.minimum(applied, level), -level)
    return -level * slip * slip.abs() - (1.0 - slip.square()) * held
