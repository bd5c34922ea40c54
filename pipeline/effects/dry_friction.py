"""Dry friction that also holds still, shared by joints, wheels and steered modules."""

import torch
from torch import Tensor

from pipeline.effects.effect import Signals, Values

Value = Tensor | float


_FASTEST = 0.99  # quantile of recorded speeds: the very greatest may be a spike
_FADED = 0.5  # of the level at rest, beyond which nothing shows that friction fades at all


def fades(velocity: Tensor, fading_velocity: Value) -> bool:
    """Whether friction of a level · exp(−(v / fading_velocity)²) fades within recorded velocities (...,)."""
    place = int(_FASTEST * (velocity.numel() - 1)) + 1
    fastest = velocity.abs().flatten().kthvalue(place).values
    return bool(torch.exp(-((fastest / fading_velocity) ** 2)) < _FADED)


def sliding_velocity_of(signals: Signals, constants: Values, group: str = "") -> Value:
    """Return below which velocity a direction is open: as each sample shows it where that is known, else at large.

    Args:
        signals: may have `sliding_velocity`, of the shape of the velocity.
        constants: have the one that holds at large.
        group: what both names begin with: a swerve's `drive_` or `steer_`.
    """
    name = f"{group}sliding_velocity"
    return signals[name] if name in signals else constants[name]


def dry_friction(
    level: Value,
    velocity: Tensor,
    applied: Tensor,
    sliding_velocity: Value,
    backward_level: Value | None = None,
) -> Tensor:
    """Mean over a sample of friction that opposes motion, or at standstill what is applied, up to its level (...,).

    An axis that passes through zero within a sample slides one way and then the other: of its level there remains the
    share of time that the one exceeds the other by. The slower it is, and the less what is applied passes the level,
    the longer it is held.
    Source: Karnopp 1985, Computer simulation of stick-slip friction (ASME J. Dyn. Syst. 107).

    Args:
        level: N·m or N.
        velocity: (...,) rad/s or m/s.
        applied: what else acts, (...,) in the unit of the level.
        sliding_velocity: in the unit of the velocity, from which on the axis slides one way only: half of what the
            velocity changes by within a sample, or what it is known to.
        backward_level: against negative motion, where it is not the same as against positive.
    """
    direction = (velocity / sliding_velocity).clamp(-1.0, 1.0)
    forward = torch.as_tensor(level, dtype=direction.dtype)
    backward = forward if backward_level is None else torch.as_tensor(backward_level, dtype=direction.dtype)
    sliding = 0.5 * ((forward + backward) * direction + (forward - backward))
    held = torch.maximum(torch.minimum(applied, forward), -backward)
    share = torch.where(applied == held, 1.0, held / torch.where(applied == held, 1.0, applied))
    resting = (1.0 - direction.square()) * share
    return -(1.0 - resting) * sliding - resting * held
