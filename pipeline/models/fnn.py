"""The feed-forward network: dense layers on the samples of a window side by side."""

from dataclasses import dataclass, field
from typing import ClassVar

from torch import nn

from simgap.models.network_model import NetworkModel, NetworkSettings
from simgap.models.settings import ModelSettings


@dataclass
class FeedForwardSettings(NetworkSettings):
    """Settings of the feed-forward network."""

    name: str = "fnn"
    sequence_length: int = 10
    hidden: list[int] = field(default_factory=lambda: [128, 64])


class FeedForwardModel(NetworkModel):
    """Dense layers with ReLU and dropout."""

    settings_class: ClassVar[type[ModelSettings]] = FeedForwardSettings
    settings: FeedForwardSettings

    def build_network(self, features: int, targets: int) -> nn.Module:
        """Return flattened window → hidden layers → increments."""
        layers: list[nn.Module] = [nn.Flatten()]
        width = features * self.settings.sequence_length
        for size, rate in zip(self.settings.hidden, self.settings.dropouts(), strict=True):
            layers += [nn.Linear(width, size), nn.ReLU(), nn.Dropout(rate)]
            width = size
        return nn.Sequential(*layers, nn.Linear(width, targets))
