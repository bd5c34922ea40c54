"""Recurrent network with an initial state from a second network that reads known samples.

Source: Mohajerin & Waslander 2019, "Multistep prediction of dynamic systems with recurrent neural networks", IEEE
Transactions on Neural Networks and Learning Systems 30(11), §III.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from simgap.errors import InputError


class Memory(NamedTuple):
    """State of a recurrent network.

    Attributes:
        recent: the newest samples, (batch, delays, features).
        hidden: of the LSTM, (batch, units).
        cell: of the LSTM, (batch, units).
    """

    recent: Tensor
    hidden: Tensor
    cell: Tensor


class RecurrentNetwork(nn.Module):
    """An LSTM over a tapped delay line; a dense head sees its state and the delay line.

    Args:
        features: of a sample.
        length: known samples from which the state is set.
        delays: samples in the delay line; 1: the newest alone.
        units: of the LSTM, and of the hidden layers of initialiser and head.
        outputs: of the head.

    Raises:
        InputError: when the delay line is longer than the window or holds nothing.
    """

    def __init__(self, features: int, length: int, delays: int, units: int, outputs: int) -> None:
        super().__init__()
        if not 1 <= delays <= length:
            raise InputError("is not between 1 and sequence_length", "model.delays", "change one of the two")
        self.delays = delays
        width = features * delays
        self.initialiser = dense(features * length, units, 2 * units)
        self.recurrence = nn.LSTMCell(width, units)
        self.head = dense(units + width, units, outputs)

    def begin(self, window: Tensor) -> Memory:
        """Set the state from known samples (batch, length, features), the newest of which is read already."""
        hidden, cell = self.initialiser(window.flatten(1)).tanh().chunk(2, dim=-1)
        return self._remember(window[:, -self.delays :], hidden, cell)

    def follow(self, memory: Memory, newest: Tensor) -> Memory:
        """Read one more sample (batch, features)."""
        recent = torch.cat([memory.recent[:, 1:], newest[:, None]], dim=1)
        return self._remember(recent, memory.hidden, memory.cell)

    def read(self, memory: Memory) -> Tensor:
        """Return the outputs (batch, outputs) after the newest sample."""
        return self.head(torch.cat([memory.hidden, memory.recent.flatten(1)], dim=1))

    def forward(self, window: Tensor) -> Tensor:
        """Return the outputs (batch, outputs) after known samples (batch, length, features)."""
        return self.read(self.begin(window))

    def _remember(self, recent: Tensor, hidden: Tensor, cell: Tensor) -> Memory:
        return Memory(recent, *self.recurrence(recent.flatten(1), (hidden, cell)))


def dense(inputs: int, units: int, outputs: int) -> nn.Sequential:
    """Return a network with one hidden layer."""
    return nn.Sequential(nn.Linear(inputs, units), nn.Tanh(), nn.Linear(units, outputs))


def silence(network: nn.Sequential) -> None:
    """Set the last layer of a dense network to zero, so that its output is zero until it is trained."""
    for parameter in network[-1].parameters():
        nn.init.zeros_(parameter)
