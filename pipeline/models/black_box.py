"""Black-box model: a recurrent network for multi-step prediction, without physics.

Source: Mohajerin, Mozifian & Waslander 2018, "Deep learning a quadrotor dynamic model for multi-step prediction".
"""

from dataclasses import dataclass
from typing import ClassVar

from torch import Tensor

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


class BlackBoxModel(NetworkModel):
    """A stack of LSTMs whose states are set from the known samples and carried over the horizon."""

    settings_class: ClassVar[type[ModelSettings]] = BlackBoxSettings
    settings: BlackBoxSettings
    network: RecurrentNetwork

    def build_network(self, features: int, targets: int) -> RecurrentNetwork:
        """Return initialiser, delay line, LSTMs and head."""
        settings = self.settings
        sizes = settings.sequence_length, settings.delays, settings.units
        return RecurrentNetwork(features, *sizes, targets, settings.layers)

    def begin(self, window: Tensor) -> Memory:
        """Set the network's state."""
        return self.network.begin(self.scaled(window))

    def follow(self, memory: Memory, newest: Tensor) -> Memory:
        """Let the network read one more sample."""
        return self.network.follow(memory, self.scaled(newest))

    def read(self, memory: Memory) -> Tensor:
        """Return the network's increments in their own units."""
        return self.unscaled(self.network.read(memory))
