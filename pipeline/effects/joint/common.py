"""Quantities that several effects of a joint share."""

import torch
from torch import Tensor

from pipeline.effects.effect import Signals, Values


def applied(signals: Signals, constants: Values) -> Tensor:
    """Effort less gravity and spring: what friction holds against at standstill (...,), N·m or N."""
    position = signals["position"]
    return (
        signals["effort"]
        - constants["gravity_torque"] * torch.sin(position)
        - constants["stiffness"] * position
    )


def on_axis(constants: Values, wrench: Tensor) -> dict[str, Tensor]:
    """Name the joint's only channel."""
    return {constants["channel"]: wrench}
