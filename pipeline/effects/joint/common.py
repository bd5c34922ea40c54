"""Quantities that several effects of a joint share."""

import torch
from torch import Tensor

from pipeline.effects.effect import Signals, Values


def applied(signals: Signals, constants: Values) -> Tensor:
    """Effort less gravity and spring: what friction holds against at standstill (...,)."""
    position = signals["position"]
    return (
        signals["effort"]
        - constants["gravity_torque"] * torch.sin(position)
        - constants["stiffness"] * position
    )


def dry_friction(level: Tensor | float, signals: Signals, constants: Values) -> Tensor:
    """Friction that opposes motion at its level, and at standstill whatever is applied, up to its level (...,).

    Below the velocity that the recording can tell from zero the one passes smoothly into the other.
    Source: Karnopp 1985, Computer simulation of stick-slip friction (ASME J. Dyn. Syst. 107).
    """
    slip = torch.tanh(signals["velocity"] / constants["sliding_velocity"])
    level = torch.as_tensor(level, dtype=slip.dtype)
    held = torch.maximum(torch.minimum(applied(signals, constants), level), -level)
    return -level * slip * slip.abs() - (1.0 - slip.square()) * held


def on_axis(constants: Values, wrench: Tensor) -> dict[str, Tensor]:
    """Name the joint's only channel."""
    return {constants["channel"]: wrench}
