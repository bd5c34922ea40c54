"""The temporal convolutional network: residual blocks of dilated causal convolutions, averaged over the window.

Source: Bai, Kolter & Koltun 2018, "An empirical evaluation of generic convolutional and recurrent networks for sequence
modeling", §3 (there without the average over time).
"""

from dataclasses import dataclass, field
from typing import ClassVar

from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.network_model import NetworkModel, NetworkSettings
from simgap.models.settings import ModelSettings


@dataclass
class TemporalConvolutionSettings(NetworkSettings):
    """Settings of the TCN; block n dilates its convolutions by 2ⁿ."""

    name: str = "tcn"
    sequence_length: int = 20
    hidden: list[int] = field(default_factory=lambda: [32] * 6)  # channels of each residual block
    dropout: list[float] = field(default_factory=lambda: [0.2] * 6)
    learning_rate: float = 3e-4
    kernel: int = 3  # samples under each convolution


class TemporalConvolutionModel(NetworkModel):
    """Residual blocks with dilations 1, 2, 4, …, each of two causal convolutions; then an average and a dense head."""

    settings_class: ClassVar[type[ModelSettings]] = TemporalConvolutionSettings
    settings: TemporalConvolutionSettings

    def build_network(self, features: int, targets: int) -> nn.Module:
        """Return residual blocks → mean over the window → increments.

        Raises:
            InputError: when the kernel is no length.
        """
        kernel = self.settings.kernel
        if kernel < 1:
            raise InputError("a kernel needs at least one sample", "model.kernel", "give a positive number")
        blocks: list[nn.Module] = []
        width = features
        for number, (size, rate) in enumerate(
            zip(self.settings.hidden, self.settings.dropouts(), strict=True)
        ):
            blocks.append(_ResidualBlock(width, size, kernel, 2**number, rate))
            width = size
        return nn.Sequential(_TimeLast(), *blocks, _MeanOverTime(), nn.Linear(width, targets))


class _ResidualBlock(nn.Module):
    def __init__(self, width: int, size: int, kernel: int, dilation: int, dropout: float) -> None:
        super().__init__()
        self.body = nn.Sequential(
            *_convolution(width, size, kernel, dilation, dropout),
            *_convolution(size, size, kernel, dilation, dropout),
        )
        self.shortcut = nn.Identity() if width == size else nn.Conv1d(width, size, 1)
        self.activation = nn.ReLU()

    def forward(self, series: Tensor) -> Tensor:
        """Map (batch, width, length) to (batch, size, length)."""
        return self.activation(self.body(series) + self.shortcut(series))


def _convolution(width: int, size: int, kernel: int, dilation: int, dropout: float) -> list[nn.Module]:
    """Return a convolution that sees a sample and those before it, with what follows it."""
    return [
        nn.ConstantPad1d(((kernel - 1) * dilation, 0), 0.0),
        nn.Conv1d(width, size, kernel, dilation=dilation),
        nn.BatchNorm1d(size),
        nn.ReLU(),
        nn.Dropout(dropout),
    ]


class _TimeLast(nn.Module):
    def forward(self, windows: Tensor) -> Tensor:
        """Map (batch, length, features) to (batch, features, length)."""
        return windows.transpose(1, 2)


class _MeanOverTime(nn.Module):
    def forward(self, series: Tensor) -> Tensor:
        """Map (batch, size, length) to (batch, size)."""
        return series.mean(-1)
