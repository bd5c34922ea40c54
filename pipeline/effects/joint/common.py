"""Quantities that several effects of a joint share."""

import torch
from torch import Tensor

from pipeline.effects.effect import Signals, Values


def direction(signals: Signals, constants: Values) -> Tensor:
    """Sign of the velocity, smooth below the velocity that the recording can tell from zero (...,)."""
    return torch.tanh(signals["velocity"] / constants["sliding_velocity"])


def on_axis(constants: Values, wrench: Tensor) -> dict[str, Tensor]:
    """Name the joint's only channel."""
    return {constants["channel"]: wrench}
