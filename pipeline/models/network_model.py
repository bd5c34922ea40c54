"""A dynamics model whose increments come from a neural network."""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field

import torch
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.examples import Examples
from simgap.models.layout import Layout
from simgap.models.restoring import take_tensors
from simgap.models.scaling import Scaler, scaler_shapes, scaler_tensors, scalers_of
from simgap.models.settings import TrainedSettings, Training
from simgap.models.windows import Series


@dataclass
class NetworkSettings(TrainedSettings):
    """Settings of all networks of stacked layers."""

    hidden: list[int] = field(default_factory=lambda: [64, 64])  # units of each hidden layer
    dropout: list[float] = field(default_factory=list)  # after each hidden layer; none where the list ends

    def dropouts(self) -> list[float]:
        """Return the dropout of every hidden layer.

        Raises:
            InputError: when sizes or rates make no network.
        """
        if any(size < 1 for size in self.hidden):
            raise InputError("a layer needs at least one unit", "model.hidden", "give positive numbers")
        if any(not 0 <= rate < 1 for rate in self.dropout) or len(self.dropout) > len(self.hidden):
            raise InputError(
                "needs one rate from 0 to below 1 per hidden layer", "model.dropout", "correct the list"
            )
        return [*self.dropout, *[0.0] * (len(self.hidden) - len(self.dropout))]


class NetworkModel(DynamicsModel):
    """Scales features and increments; the rest is a network of (batch, length, features) in float32."""

    settings: TrainedSettings

    def __init__(self, layout: Layout, settings: TrainedSettings, time_step: float) -> None:
        super().__init__(layout, settings, time_step)
        self.network = self.build_network(len(layout.features), len(layout.targets))

    @abstractmethod
    def build_network(self, features: int, targets: int) -> nn.Module:
        """Return a network from (batch, length, features) to (batch, targets)."""

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Train until the validation loss stops falling, and keep the weights with which it was lowest."""
        from simgap.models.rollout_training import train_rollouts
        from simgap.models.training import train_network

        context = context or FitContext()
        examples, held = self.examples(train, "training"), self.examples(validation, "validation")
        held = held.at_most(training.validation_windows)
        self.prepare(examples, context)
        loss = train_network(
            self.network, self._scaled(examples), self._scaled(held), self.settings, training, context
        )
        self.network.eval()
        if training.steps > 1:
            loss = train_rollouts(self, train, validation, training, context)
        return loss

    def prepare(self, examples: Examples, context: FitContext) -> None:
        """Fit the scaling and draw new weights."""
        self.inputs = Scaler.fit(examples.features, self.settings.scaling)
        self.outputs = Scaler.fit(examples.targets[examples.seen()], "standard")
        torch.manual_seed(context.seed)
        self.network = self.build_network(examples.features.shape[1], examples.targets.shape[1])

    def increments(self, features: Tensor) -> Tensor:
        """Return the network's increments in their own units."""
        return self.unscaled(self.network(self.scaled(features)))

    def scaled(self, features: Tensor) -> Tensor:
        """Return features as the network sees them."""
        return self.inputs.apply(features.to(self.inputs.centre)).float()

    def unscaled(self, outputs: Tensor) -> Tensor:
        """Return what the network gives in the units of the increments."""
        return self.outputs.undo(outputs.to(self.outputs.centre))

    def tensors(self) -> dict[str, Tensor]:
        """Return weights and scaling."""
        return {
            f"network.{name}": tensor for name, tensor in self.network.state_dict().items()
        } | scaler_tensors(self.inputs, self.outputs)

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over weights and scaling."""
        features, targets = len(self.layout.features), len(self.layout.targets)
        shapes: dict[str, tuple[int, ...]] = {
            f"network.{name}": tuple(tensor.shape) for name, tensor in self.network.state_dict().items()
        }
        shapes |= scaler_shapes(features, targets)
        own = take_tensors(tensors, shapes)
        self.inputs, self.outputs = scalers_of(own)
        weights = {name: own[f"network.{name}"] for name in self.network.state_dict()}
        self.network.load_state_dict(weights)
        self.network.eval()

    def _scaled(self, examples: Examples) -> Examples:
        features = self.inputs.apply(examples.features).float()
        targets = self.outputs.apply(examples.targets).float()
        return Examples(features, targets, examples.starts, examples.length)
