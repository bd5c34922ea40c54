"""Dry friction that also holds still, shared by joints, wheels and steered modules."""

import torch
from torch import Tensor

Value = Tensor | float


_FASTEST = 0.99  # quantile of recorded speeds: the very greatest may be a spike
_FADED = 0.5  # of the level at rest, beyond which nothing shows that friction fades at all


def fades(velocity: Tensor, fading_velocity: Value) -> bool:
    """Whether friction of a level · exp(−(v / fading_velocity)²) fades within recorded velocities (...,)."""
    place = int(_FASTEST * (velocity.numel() - 1)) + 1
    fastest = velocity.abs().flatten().kthvalue(place).values
    return bool(torch.exp(-((fastest / fading_velocity) ** 2)) < _FADED)


def dry_friction(
    level: Value,
    velocity: Tensor,
    applied: Tensor,
    sliding_velocity: Value,
    backward_level: Value | None = None,
) -> Tensor:
    """Friction that opposes motion at its level, and at standstill whatever is applied, up to its level (...,).

    Below the velocity that the recording can tell from zero the one passes smoothly into the other.
    Source: Karnopp 1985, Computer simulation of stick-slip friction (ASME J. Dyn. Syst. 107).

    Args:
        level: N·m or N.
        velocity: (...,) rad/s or m/s.
        applied: what else acts, (...,) in the unit of the level.
        sliding_velocity: in the unit of the velocity; far above it the axis slides.
        backward_level: against negative motion, where it is not the same as against positive.
    """
    slip = torch.tanh(velocity / sliding_velocity)
    forward = torch.as_tensor(level, dtype=slip.dtype)
    backward = forward if backward_level is None else torch.as_tensor(backward_level, dtype=slip.dtype)
    held = torch.maximum(torch.minimum(applied, forward), -backward)
    sliding = torch.where(slip > 0, forward, backward) * slip * slip.abs()
    return -sliding - (1.0 - slip.square()) * held
