"""Recurrent network with an initial state from a second network that reads known samples.

Source: Mohajerin & Waslander 2019, "Multistep prediction of dynamic systems with recurrent neural networks", IEEE
Transactions on Neural Networks and Learning Systems 30(11), §III.
"""

from itertools import pairwise
from typing import NamedTuple

import torch
from torch import Tensor, nn

from simgap.errors import InputError


class Memory(NamedTuple):
    """State of a recurrent network.

    Attributes:
        recent: the newest samples, (batch, delays, features).
        beside: what is known of the present alone, (batch, beside).
        hidden: of each LSTM, (layers, batch, units).
        cell: of each LSTM, (layers, batch, units).
    """

    recent: Tensor
    beside: Tensor
    hidden: Tensor
    cell: Tensor


class RecurrentNetwork(nn.Module):
    """A stack of LSTMs over a tapped delay line; a dense head sees the state of the last one and the delay line.

    Args:
        features: of a sample.
        length: known samples from which the state is set.
        delays: samples in the delay line; 1: the newest alone.
        units: of every LSTM, and of the hidden layers of initialiser and head.
        outputs: of the head.
        layers: LSTMs in the stack.
        beside: values of the present that are seen with the delay line and do not stand in it.

    Raises:
        InputError: when the delay line is longer than the window or holds nothing, or the stack has no layer.
    """

    def __init__(
        self,
        features: int,
        length: int,
        delays: int,
        units: int,
        outputs: int,
        layers: int = 1,
        beside: int = 0,
    ) -> None:
        super().__init__()
        if not 1 <= delays <= length:
            raise InputError("is not between 1 and sequence_length", "model.delays", "change one of the two")
        if layers < 1:
            raise InputError("a stack has at least one layer", "model.layers", "give a positive number")
        self.delays, self.layers = delays, layers
        width = features * delays + beside
        self.initialiser = dense(features * length, units, 2 * units * layers)
        self.stack = nn.ModuleList(nn.LSTMCell(*sizes) for sizes in pairwise([width, *[units] * layers]))
        self.head = dense(units + width, units, outputs)

    def begin(self, window: Tensor, beside: Tensor | None = None) -> Memory:
        """Set the state from known samples (batch, length, features), the newest of which is read already."""
        states = self.initialiser(window.flatten(1)).tanh().unflatten(1, (2, self.layers, -1))
        hidden, cell = states.movedim(0, 2)
        return self._remember(window[:, -self.delays :], beside, hidden, cell)

    def follow(self, memory: Memory, newest: Tensor, beside: Tensor | None = None) -> Memory:
        """Read one more sample (batch, features), and what stands beside it (batch, beside)."""
        recent = torch.cat([memory.recent[:, 1:], newest[:, None]], dim=1)
        return self._remember(recent, beside, memory.hidden, memory.cell)

    def read(self, memory: Memory) -> Tensor:
        """Return the outputs (batch, outputs) after the newest sample."""
        return self.head(torch.cat([memory.hidden[-1], memory.recent.flatten(1), memory.beside], dim=1))

    def forward(self, window: Tensor, beside: Tensor | None = None) -> Tensor:
        """Return the outputs (batch, outputs) after known samples (batch, length, features)."""
        return self.read(self.begin(window, beside))

    def _remember(self, recent: Tensor, beside: Tensor | None, hidden: Tensor, cell: Tensor) -> Memory:
        beside = recent.new_zeros(len(recent), 0) if beside is None else beside
        seen, states = torch.cat([recent.flatten(1), beside], dim=1), []
        for layer, *state in zip(self.stack, hidden.unbind(), cell.unbind(), strict=True):
            states.append(layer(seen, tuple(state)))
            seen = states[-1][0]
        return Memory(recent, beside, *(torch.stack(part) for part in zip(*states, strict=True)))


def dense(inputs: int, units: int, outputs: int) -> nn.Sequential:
    """Return a network with one hidden layer."""
    return nn.Sequential(nn.Linear(inputs, units), nn.Tanh(), nn.Linear(units, outputs))


def silence(network: nn.Sequential) -> None:
    """Set the last layer of a dense network to zero, so that its output is zero until it is trained."""
    for parameter in network[-1].parameters():
        nn.init.zeros_(parameter)
