"""Black-box model: a recurrent network for multi-step prediction, without physics.

Source: Mohajerin, Mozifian & Waslander 2018, "Deep learning a quadrotor dynamic model for multi-step prediction". There
are two networks there, one for velocity and one for body rate; `separate` has them.
"""

from dataclasses import dataclass
from itertools import groupby
from typing import Any, ClassVar, cast

import torch
from torch import Tensor, nn

from simgap.models.network_model import NetworkModel
from simgap.models.recurrent_network import Memory, RecurrentNetwork
from simgap.models.settings import ModelSettings, TrainedSettings


@dataclass
class BlackBoxSettings(TrainedSettings):
    """Settings of the black box."""

    name: str = "black_box"
    sequence_length: int = 20
    units: int = 32  # of every LSTM
    layers: int = 7  # LSTMs in the stack
    delays: int = 1  # newest samples that the network sees at each step
    learning_rate: float = 2e-3
    separate: bool = False  # whether each quantity of the targets, as body_rate, has a network of its own


class SideBySide(nn.Module):
    """Networks that see the same samples; each has its own part of the outputs."""

    def __init__(self, networks: list[RecurrentNetwork]) -> None:
        super().__init__()
        # Registered as modules; a list to the type checker, which takes what is in a ModuleList for any module.
        self.networks = cast(list[RecurrentNetwork], nn.ModuleList(networks))

    def begin(self, window: Tensor) -> tuple[Memory, ...]:
        """Set the state of each from known samples (batch, length, features)."""
        return tuple(network.begin(window) for network in self.networks)

    def follow(self, memory: tuple[Memory, ...], newest: Tensor) -> tuple[Memory, ...]:
        """Let each read one more sample (batch, features)."""
        return tuple(network.follow(own, newest) for network, own in zip(self.networks, memory, strict=True))

    def read(self, memory: tuple[Memory, ...]) -> Tensor:
        """Return all outputs (batch, outputs)."""
        return torch.cat(
            [network.read(own) for network, own in zip(self.networks, memory, strict=True)], dim=1
        )

    def forward(self, window: Tensor) -> Tensor:
        """Return all outputs (batch, outputs) after known samples (batch, length, features)."""
        return self.read(self.begin(window))


class BlackBoxModel(NetworkModel):
    """A stack of LSTMs whose states are set from the known samples and carried over the horizon."""

    settings_class: ClassVar[type[ModelSettings]] = BlackBoxSettings
    settings: BlackBoxSettings
    network: RecurrentNetwork | SideBySide

    def build_network(self, features: int, targets: int) -> RecurrentNetwork | SideBySide:
        """Return initialiser, delay line, LSTMs and head, or these of each network."""
        settings = self.settings
        sizes = settings.sequence_length, settings.delays, settings.units
        if not settings.separate:
            return RecurrentNetwork(features, *sizes, targets, settings.layers)
        stems = groupby(name.rpartition("_")[0] for name in self.layout.targets)
        outputs = [len(list(names)) for _, names in stems]
        return SideBySide([RecurrentNetwork(features, *sizes, own, settings.layers) for own in outputs])

    def begin(self, window: Tensor) -> Any:
        """Set the states of the networks."""
        return self.network.begin(self.scaled(window))

    def follow(self, memory: Any, newest: Tensor) -> Any:
        """Let the networks read one more sample."""
        return self.network.follow(memory, self.scaled(newest))

    def read(self, memory: Any) -> Tensor:
        """Return the increments in their own units."""
        return self.unscaled(self.network.read(memory))
