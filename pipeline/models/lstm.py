"""The recurrent network: stacked LSTM layers over the window, a dense head on the last output.

Source: Hochreiter & Schmidhuber 1997, "Long short-term memory", Neural Computation 9(8).
"""

from dataclasses import dataclass, field
from typing import ClassVar

from torch import Tensor, nn

from simgap.models.network_model import NetworkModel, NetworkSettings
from simgap.models.settings import ModelSettings


@dataclass
class LongShortTermMemorySettings(NetworkSettings):
    """Settings of the LSTM."""

    name: str = "lstm"
    sequence_length: int = 10
    scaling: str = "robust"
    hidden: list[int] = field(default_factory=lambda: [64, 32])
    learning_rate: float = 3e-3
    batch_normalisation: bool = True  # after each recurrent layer


class LongShortTermMemoryModel(NetworkModel):
    """LSTM layers, each with batch normalisation and dropout."""

    settings_class: ClassVar[type[ModelSettings]] = LongShortTermMemorySettings
    settings: LongShortTermMemorySettings

    def build_network(self, features: int, targets: int) -> nn.Module:
        """Return recurrent layers → last sample → increments."""
        layers: list[nn.Module] = []
        width = features
        for size, rate in zip(self.settings.hidden, self.settings.dropouts(), strict=True):
            layers.append(_RecurrentLayer(width, size, rate, self.settings.batch_normalisation))
            width = size
        return nn.Sequential(*layers, _LastSample(), nn.Linear(width, targets))


class _RecurrentLayer(nn.Module):
    def __init__(self, width: int, size: int, dropout: float, normalise: bool) -> None:
        super().__init__()
        self.recurrence = nn.LSTM(width, size, batch_first=True)
        self.normalisation = nn.BatchNorm1d(size) if normalise else nn.Identity()
        self.dropout = nn.Dropout(dropout)

    def forward(self, windows: Tensor) -> Tensor:
        """Map (batch, length, width) to (batch, length, size)."""
        outputs, _ = self.recurrence(windows)
        return self.dropout(self.normalisation(outputs.transpose(1, 2)).transpose(1, 2))


class _LastSample(nn.Module):
    def forward(self, windows: Tensor) -> Tensor:
        """Map (batch, length, size) to (batch, size)."""
        return windows[:, -1]
