"""Hybrids: a motion model between recurrent networks, all trained together through their rollouts.

    samples ─► input model ─► motion model ─► increment
    samples and motion model's increment ─► output model

parallel   increment = motion model's + output model's
serial     increment = output model's, which begins as the motion model's

The input model says what drives the motion model: the recorded inputs, corrected. The last layers of the networks start
at zero, so both hybrids start with the predictions of the motion model. Its coefficients are learned as well, by a
factor each. Source: Mohajerin, Mozifian & Waslander 2018, "Deep learning a quadrotor dynamic model for multi-step
prediction".
"""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from copy import copy
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
from simgap.models.recurrent_network import Memory, RecurrentNetwork, silence
from simgap.models.scaling import Scaler
from simgap.models.selection import class_from, settings_from
from simgap.models.settings import ModelSettings, TrainedSettings, Training
from simgap.models.white_box import WhiteBoxModel
from simgap.models.windows import Series

_MOTION_PREFIX = "motion."  # begins the names of the motion model's tensors


@dataclass
class HybridSettings(TrainedSettings):
    """Settings of both hybrids."""

    sequence_length: int = 20
    units: int = 32  # of every LSTM
    layers: int = 4  # LSTMs in each of the two networks
    delays: int = 1  # newest samples that the networks see at each step
    learning_rate: float = 2e-3
    motion: dict[str, Any] = field(
        default_factory=lambda: {"name": "white_box"}
    )  # any model solved in closed form
    motion_learned: bool = True  # whether the coefficients of a white box are learned with the networks
    unseen: list[str] = field(default_factory=list)  # features that no network sees, as gravity_*
    driven: list[str] = field(
        default_factory=lambda: ["*"]
    )  # features of the inputs that the input model corrects; none: the recorded inputs drive
    corrected: list[str] = field(
        default_factory=lambda: ["*"]
    )  # targets that the output model corrects, as body_rate_*


class HybridMemory(NamedTuple):
    """State of a hybrid.

    Attributes:
        window: what the motion model has seen, (batch, its length, features).
        motion: the motion model's increment after the window, as the input model drives it, (batch, targets).
        input: what the input model remembers.
        output: what the output model remembers.
    """

    window: Tensor
    motion: Tensor
    input: Memory
    output: Memory


class HybridNetwork(nn.Module):
    """What is trained of a hybrid.

    Args:
        input_model: sees the samples; its outputs are the corrections of the motion model's inputs.
        output_model: sees the samples and, beside them, the motion model's increment.
        coefficients: terms in each equation of the motion model whose coefficients are learned; empty: none.
        passing: targets that a matrix passes from the motion model on to the output; 0: none.
    """

    def __init__(
        self,
        input_model: RecurrentNetwork,
        output_model: RecurrentNetwork,
        coefficients: Sequence[int],
        passing: int = 0,
    ) -> None:
        super().__init__()
        self.input, self.output = input_model, output_model
        self.changes = nn.ParameterList(torch.zeros(count) for count in coefficients)
        self.passing = nn.Parameter(torch.eye(passing))


class HybridModel(NetworkModel):
    """Base of both hybrids. The motion model is fitted first."""

    fits_residuals = False
    settings: HybridSettings
    network: HybridNetwork
    passes: ClassVar[bool] = False
    """Whether the motion model's increment reaches the output through the output model alone."""

    def __init__(self, layout: Layout, settings: HybridSettings, time_step: float) -> None:
        self.motion = _motion_model(layout, settings, time_step)
        self.seen = 1.0 - _mask_of(layout.features, settings.unseen, "model.unseen")
        self.driven = _mask_of(layout.features[-layout.input_features :], settings.driven, "model.driven")
        self.corrected = _mask_of(layout.targets, settings.corrected, "model.corrected")
        self.compensated = True
        super().__init__(layout, settings, time_step)

    def build_network(self, features: int, targets: int) -> HybridNetwork:
        """Return input and output model, and the changes of the motion model's coefficients."""
        settings = self.settings

        def stack(outputs: int, beside: int = 0) -> RecurrentNetwork:
            sizes = settings.sequence_length, settings.delays, settings.units
            network = RecurrentNetwork(features, *sizes, outputs, settings.layers, beside)
            silence(network.head)
            return network

        white_box = (
            self.motion if isinstance(self.motion, WhiteBoxModel) and settings.motion_learned else None
        )
        counts = white_box.counts() if white_box else []
        passing = targets if self.passes else 0
        network = HybridNetwork(
            stack(self.layout.input_features), stack(targets, beside=targets), counts, passing
        )
        if white_box:
            white_box.changes = network.changes
        return network

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Fit the motion model, then train all parts through predictions of `training.steps` steps."""
        from simgap.models.rollout_training import train_rollouts

        context = context or FitContext()
        self.motion.fit(train, validation, training, context)
        self.prepare(self.examples(train, "training"), context)
        return train_rollouts(self, train, validation, training, context)

    def prepare(self, examples: Examples, context: FitContext) -> None:
        """Scale increments by what the motion model, fitted before, leaves to be corrected."""
        super().prepare(examples, context)
        left = [
            targets - self.motion.increments(self._recent(windows)) for windows, targets in examples.chunks()
        ]
        self.outputs = Scaler.fit(torch.cat(left).detach(), "standard")

    def increments(self, features: Tensor) -> Tensor:
        """Return what the first step of a rollout adds."""
        return self.read(self.begin(features))

    def begin(self, window: Tensor) -> HybridMemory:
        """Set the networks' states from the known samples; the motion model sees the newest of them."""
        known, recent = self.scaled(window), self._recent(window)
        driving = self.network.input.begin(known)
        motion = self._driven(recent, driving)
        return HybridMemory(
            recent, motion, driving, self.network.output.begin(known, self._scaled_increment(motion))
        )

    def follow(self, memory: HybridMemory, newest: Tensor) -> HybridMemory:
        """Let all three see one more sample."""
        sample, recent = self.scaled(newest), self.motion.follow(memory.window, newest)
        driving = self.network.input.follow(memory.input, sample)
        motion = self._driven(recent, driving)
        output = self.network.output.follow(memory.output, sample, self._scaled_increment(motion))
        return HybridMemory(recent, motion, driving, output)

    def read(self, memory: HybridMemory) -> Tensor:
        """Return the increments; without compensation those of the motion model."""
        if not self.compensated:
            return memory.motion
        compensated = self.compensate(memory.motion, self.network.output.read(memory.output))
        return torch.where(self.corrected.bool(), compensated, memory.motion)

    @abstractmethod
    def compensate(self, motion: Tensor, output: Tensor) -> Tensor:
        """Return the increments (batch, targets) from the motion model's and the output model's scaled value."""

    def parts(self) -> dict[str, DynamicsModel]:
        """Return the same chain without its output model: the errors before compensation."""
        chain = copy(self)
        chain.compensated = False
        return {"uncompensated": chain}

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

    def scaled(self, features: Tensor) -> Tensor:
        """Return features as the networks see them: those that they are not to see are zero."""
        return super().scaled(features) * self.seen

    def _recent(self, window: Tensor) -> Tensor:
        """Return the samples that the motion model sees."""
        return window[:, -self.motion.settings.sequence_length :]

    def _driven(self, window: Tensor, driving: Memory) -> Tensor:
        """Return the motion model's increment, the inputs of its newest sample corrected by the input model."""
        inputs = self.layout.input_features
        spread = self.inputs.spread[-inputs:].to(window)
        correction = self.network.input.read(driving) * self.driven * spread
        newest = torch.cat([window[:, -1, :-inputs], window[:, -1, -inputs:] + correction], dim=1)
        return self.motion.read(torch.cat([window[:, :-1], newest[:, None]], dim=1))

    def _scaled_increment(self, increment: Tensor) -> Tensor:
        """Return what the output model sees of the motion model's increment: the targets that it corrects."""
        return self.outputs.apply(increment.to(self.outputs.centre)).float() * self.corrected


@dataclass
class HybridParallelSettings(HybridSettings):
    """Settings of the hybrid whose output model adds to the motion model."""

    name: str = "hybrid_parallel"


class HybridParallelModel(HybridModel):
    """The output model adds to the increments of the motion model."""

    settings_class: ClassVar[type[ModelSettings]] = HybridParallelSettings

    def compensate(self, motion: Tensor, output: Tensor) -> Tensor:
        """Return the sum of both."""
        return motion + output * self.outputs.spread


@dataclass
class HybridSerialSettings(HybridSettings):
    """Settings of the hybrid whose output model stands behind the motion model."""

    name: str = "hybrid_serial"


class HybridSerialModel(HybridModel):
    """The value of the output model is the increment; its last layer sees the motion model's as well."""

    settings_class: ClassVar[type[ModelSettings]] = HybridSerialSettings
    passes: ClassVar[bool] = True

    def compensate(self, motion: Tensor, output: Tensor) -> Tensor:
        """Return the output model's value: its head's and what it passes on of the motion model's."""
        return self.unscaled(self._scaled_increment(motion) @ self.network.passing.T + output)


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
