"""The temporal convolutional network: residual blocks of dilated causal convolutions, averaged over the window.

Source: Bai, Kolter & Koltun 2018, "An empirical evaluation of generic convolutional and recurrent networks for sequence
modeling", §3 (there without the average over time). Settings add what the networks for swerve drives have besides
("Beyond linear horizons"): normalised inputs, a first convolution, dense layers, no ReLU just before the skip sum.
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
    stem: int | None = None  # channels of a convolution of normalised inputs before the blocks; null: none
    activated: bool = True  # whether a ReLU stands just before the sum with the skip connection
    dense: list[int] = field(default_factory=list)  # units of dense layers between average and increments
    dense_dropout: float = 0.3  # after each of them


class TemporalConvolutionModel(NetworkModel):
    """Residual blocks with dilations 1, 2, 4, …, each of two causal convolutions; then an average and a dense head."""

    settings_class: ClassVar[type[ModelSettings]] = TemporalConvolutionSettings
    settings: TemporalConvolutionSettings

    def build_network(self, features: int, targets: int) -> nn.Module:
        """Return residual blocks → mean over the window → dense layers → increments.

        Raises:
            InputError: when the kernel is no length, or a layer has no unit or no rate.
        """
        self._check()
        kernel, stem = self.settings.kernel, self.settings.stem
        blocks: list[nn.Module] = []
        width = features
        if stem is not None:
            blocks += [nn.BatchNorm1d(features), *_convolution(features, stem, kernel, 1), nn.ReLU()]
            width = stem
        for number, (size, rate) in enumerate(
            zip(self.settings.hidden, self.settings.dropouts(), strict=True)
        ):
            blocks.append(_ResidualBlock(width, size, kernel, 2**number, rate, self.settings.activated))
            width = size
        head: list[nn.Module] = []
        for size in self.settings.dense:
            head += [nn.Linear(width, size), nn.ReLU(), nn.Dropout(self.settings.dense_dropout)]
            width = size
        return nn.Sequential(_TimeLast(), *blocks, _MeanOverTime(), *head, nn.Linear(width, targets))

    def _check(self) -> None:
        settings = self.settings
        if settings.kernel < 1:
            raise InputError("a kernel needs at least one sample", "model.kernel", "give a positive number")
        if settings.stem is not None and settings.stem < 1:
            raise InputError("needs at least one channel", "model.stem", "give a positive number, or null")
        if any(size < 1 for size in settings.dense):
            raise InputError("a layer needs at least one unit", "model.dense", "give positive numbers")
        if not 0.0 <= settings.dense_dropout < 1.0:
            raise InputError("is a rate from 0 to below 1", "model.dense_dropout", "correct it")


class _ResidualBlock(nn.Module):
    def __init__(
        self, width: int, size: int, kernel: int, dilation: int, dropout: float, activated: bool
    ) -> None:
        super().__init__()
        self.body = nn.Sequential(
            *_convolution(width, size, kernel, dilation),
            nn.ReLU(),
            nn.Dropout(dropout),
            *_convolution(size, size, kernel, dilation),
            nn.ReLU() if activated else nn.Identity(),
            nn.Dropout(dropout),
        )
        self.shortcut = nn.Identity() if width == size else nn.Conv1d(width, size, 1)
        self.activation = nn.ReLU()

    def forward(self, series: Tensor) -> Tensor:
        """Map (batch, width, length) to (batch, size, length)."""
        return self.activation(self.body(series) + self.shortcut(series))


def _convolution(width: int, size: int, kernel: int, dilation: int) -> list[nn.Module]:
    """Return a convolution that sees a sample and those before it, normalised over batch and window."""
    return [
        nn.ConstantPad1d(((kernel - 1) * dilation, 0), 0.0),
        nn.Conv1d(width, size, kernel, dilation=dilation),
        nn.BatchNorm1d(size),
    ]


class _TimeLast(nn.Module):
    def forward(self, windows: Tensor) -> Tensor:
        """Map (batch, length, features) to (batch, features, length)."""
        return windows.transpose(1, 2)


class _MeanOverTime(nn.Module):
    def forward(self, series: Tensor) -> Tensor:
        """Map (batch, size, length) to (batch, size)."""
        return series.mean(-1)
