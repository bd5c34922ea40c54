"""Hybrids: recurrent networks around a motion model that is differentiable, trained through its rollouts.

parallel   increment = motion(window) + network(samples)
serial     increment = motion(window, its newest sample corrected by an input network), corrected by an output network

The last layer of every network starts at zero, so both start with the predictions of the motion model. Source:
Mohajerin, Mozifian & Waslander 2018, "Deep learning a quadrotor dynamic model for multi-step prediction".
"""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any, ClassVar, NamedTuple

import torch
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.closed_form import CLOSED_FORM
from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.examples import Examples
from simgap.models.layout import Layout
from simgap.models.network_model import NetworkModel
from simgap.models.recurrent_network import Memory, RecurrentNetwork, dense, silence
from simgap.models.scaling import Scaler
from simgap.models.selection import class_from, settings_from
from simgap.models.settings import ModelSettings, TrainedSettings, Training
from simgap.models.windows import Series

_MOTION_PREFIX = "motion."  # begins the names of the motion model's tensors


@dataclass
class HybridSettings(TrainedSettings):
    """Settings of both hybrids."""

    sequence_length: int = 20
    units: int = 64  # of the LSTM
    delays: int = 1  # newest samples that the network sees at each step
    learning_rate: float = 2e-3
    motion: dict[str, Any] = field(
        default_factory=lambda: {"name": "white_box"}
    )  # any model solved in closed form
    unseen: list[str] = field(default_factory=list)  # features that no network sees, as gravity_*
    corrected: list[str] = field(
        default_factory=lambda: ["*"]
    )  # targets that networks correct, as body_rate_*


class HybridMemory(NamedTuple):
    """State of a hybrid.

    Attributes:
        window: what the motion model sees, (batch, its length, features).
        network: what the network remembers.
    """

    window: Tensor
    network: Memory


class HybridModel(NetworkModel):
    """Base of both hybrids. The motion model is fitted first and stays fixed."""

    fits_residuals = False
    settings: HybridSettings

    def __init__(self, layout: Layout, settings: HybridSettings, time_step: float) -> None:
        self.motion = _motion_model(layout, settings, time_step)
        self.seen = 1.0 - _mask_of(layout.features, settings.unseen, "model.unseen")
        self.corrected = _mask_of(layout.targets, settings.corrected, "model.corrected")
        super().__init__(layout, settings, time_step)

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Fit the motion model, then train the networks through predictions of `training.steps` steps."""
        from simgap.models.rollout_training import train_rollouts

        context = context or FitContext()
        self.motion.fit(train, validation, training, context)
        self.prepare(self.examples(train, "training"), context)
        return train_rollouts(self, train, validation, training, context)

    def prepare(self, examples: Examples, context: FitContext) -> None:
        """Scale corrections by what the motion model, fitted before, leaves to be corrected."""
        super().prepare(examples, context)
        left = [
            targets - self.motion.increments(self._recent(windows)) for windows, targets in examples.chunks()
        ]
        self.outputs = Scaler.fit(torch.cat(left), "standard")

    def increments(self, features: Tensor) -> Tensor:
        """Return what the first step of a rollout adds."""
        return self.read(self.begin(features))

    def begin(self, window: Tensor) -> HybridMemory:
        """Set the network's state from the known samples; the motion model sees the newest of them."""
        return HybridMemory(self._recent(window), self.recurrence.begin(self.scaled(window)))

    def follow(self, memory: HybridMemory, newest: Tensor) -> HybridMemory:
        """Let both see one more sample."""
        return HybridMemory(
            self.motion.follow(memory.window, newest),
            self.recurrence.follow(memory.network, self.scaled(newest)),
        )

    @property
    @abstractmethod
    def recurrence(self) -> RecurrentNetwork:
        """The network with a state."""

    def tensors(self) -> dict[str, Tensor]:
        """Return weights, scaling and the motion model's."""
        return super().tensors() | {
            f"{_MOTION_PREFIX}{name}": own for name, own in self.motion.tensors().items()
        }

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over weights, scaling and the motion model's."""
        super().restore({name: own for name, own in tensors.items() if not name.startswith(_MOTION_PREFIX)})
        self.motion.restore(
            {
                name.removeprefix(_MOTION_PREFIX): own
                for name, own in tensors.items()
                if name.startswith(_MOTION_PREFIX)
            }
        )

    def corrections(self, outputs: Tensor) -> Tensor:
        """Return a network's corrections of increments, in their units."""
        return outputs * self.corrected * self.outputs.spread

    def scaled(self, features: Tensor) -> Tensor:
        """Return features as the networks see them: those that they are not to see are zero."""
        return super().scaled(features) * self.seen

    def _recent(self, window: Tensor) -> Tensor:
        """Return the samples that the motion model sees."""
        return window[:, -self.motion.settings.sequence_length :]

    def _recurrent_network(self, features: int, outputs: int) -> RecurrentNetwork:
        settings = self.settings
        network = RecurrentNetwork(
            features, settings.sequence_length, settings.delays, settings.units, outputs
        )
        silence(network.head)
        return network


@dataclass
class HybridParallelSettings(HybridSettings):
    """Settings of the hybrid with a network in parallel with the motion model."""

    name: str = "hybrid_parallel"


class HybridParallelModel(HybridModel):
    """The network adds to the increments of the motion model."""

    settings_class: ClassVar[type[ModelSettings]] = HybridParallelSettings
    network: RecurrentNetwork

    def build_network(self, features: int, targets: int) -> RecurrentNetwork:
        """Return the network beside the motion model."""
        return self._recurrent_network(features, targets)

    @property
    def recurrence(self) -> RecurrentNetwork:
        """The network itself."""
        return self.network

    def read(self, memory: HybridMemory) -> Tensor:
        """Return the sum of both."""
        return self.motion.read(memory.window) + self.corrections(self.network.read(memory.network))


@dataclass
class HybridSerialSettings(HybridSettings):
    """Settings of the hybrid with networks in series with the motion model."""

    name: str = "hybrid_serial"


class HybridSerialModel(HybridModel):
    """An input network corrects the input of the motion model, and an output network its output."""

    settings_class: ClassVar[type[ModelSettings]] = HybridSerialSettings
    network: nn.ModuleDict

    def build_network(self, features: int, targets: int) -> nn.ModuleDict:
        """Return a recurrent input network and a dense output network, which sees newest sample and increment."""
        output = dense(features + targets, self.settings.units, targets)
        silence(output)
        return nn.ModuleDict({"input": self._recurrent_network(features, features), "output": output})

    @property
    def recurrence(self) -> RecurrentNetwork:
        """The input network."""
        network = self.network["input"]
        assert isinstance(network, RecurrentNetwork)
        return network

    def read(self, memory: HybridMemory) -> Tensor:
        """Return the increments of the corrected window, corrected."""
        correction = self.recurrence.read(memory.network).to(self.inputs.spread) * self.inputs.spread
        newest = memory.window[:, -1] + correction
        window = torch.cat([memory.window[:, :-1], newest[:, None]], dim=1)
        increment = self.motion.read(window)
        seen = torch.cat([self.scaled(newest), self.outputs.apply(increment).float()], dim=1)
        return increment + self.corrections(self.network["output"](seen))


def _mask_of(names: Sequence[str], patterns: Sequence[str], where: str) -> Tensor:
    """Return one for each name that matches a pattern and zero for the others, (names,) float32.

    Raises:
        InputError: when a pattern matches nothing.
    """
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in names):
            raise InputError(f"{pattern!r} matches none of {', '.join(names)}", where, "correct it")
    return torch.tensor([float(any(fnmatchcase(name, own) for own in patterns)) for name in names])


def _motion_model(layout: Layout, settings: HybridSettings, time_step: float) -> DynamicsModel:
    """Return the untrained motion model.

    Raises:
        InputError: when it is none that is solved in closed form, or sees more samples than the hybrid.
    """
    motion_class = class_from(CLOSED_FORM, settings.motion, "motion model", "model.motion")
    own = settings_from(CLOSED_FORM, settings.motion)
    if own.sequence_length > settings.sequence_length:
        raise InputError("is longer than model.sequence_length", "model.motion.sequence_length", "shorten it")
    return motion_class(layout, own, time_step)
