"""Nonlinear autoregression with exogenous inputs (NARX): the next output from the last outputs and inputs.

Fitted in series-parallel form, on recorded outputs, and run in parallel form, on its own (Narendra &
Parthasarathy 1990, "Identification and control of dynamical systems using neural networks", IEEE Transactions
on Neural Networks 1(1)).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models import hidden_layer
from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.examples import Examples
from simgap.models.levenberg_marquardt import Solution, minimise
from simgap.models.restoring import take_tensors
from simgap.models.scaling import Scaler, scaler_shapes, scaler_tensors, scalers_of
from simgap.models.settings import ModelSettings, Training
from simgap.models.windows import Series


@dataclass
class NarxSettings(ModelSettings):
    """Settings of the NARX network."""

    name: str = "narx"
    sequence_length: int = 4
    input_delays: int | None = None  # last samples of the inputs that are seen; null: all of the window
    output_delays: int | None = None  # last samples of the outputs that are seen; null: all of the window
    hidden: int = 10  # units of the hidden layer

    def delays(self) -> tuple[int, int]:
        """Return how many samples of the inputs and of the outputs are seen.

        Raises:
            InputError: when the window does not hold them, or there is no unit.
        """
        if self.hidden < 1:
            raise InputError("a layer needs at least one unit", "model.hidden", "give a positive number")
        chosen = []
        for key in ("input_delays", "output_delays"):
            delays = getattr(self, key)
            if delays is not None and not 1 <= delays <= self.sequence_length:
                remedy = "give 1 to model.sequence_length"
                raise InputError(f"must fit into the window, is {delays}", f"model.{key}", remedy)
            chosen.append(self.sequence_length if delays is None else delays)
        return chosen[0], chosen[1]


class NarxModel(DynamicsModel):
    """A network for each target, trained by Levenberg–Marquardt in float64.

    A training takes seconds to a few minutes: a killed one begins anew.
    """

    settings_class: ClassVar[type[ModelSettings]] = NarxSettings
    settings: NarxSettings

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Train on recorded windows and keep the weights with the lowest validation loss of each target."""
        context = context or FitContext()
        self.settings.delays()
        examples, held = self.examples(train, "training"), self.examples(validation, "validation")
        self.inputs = Scaler.fit(examples.features, self.settings.scaling)
        self.outputs = Scaler.fit(examples.targets[examples.seen()], "standard")
        regressors, targets = self._all(examples)
        held_regressors, held_targets = self._all(held)
        random = torch.Generator().manual_seed(context.seed)
        solutions = [
            minimise(
                hidden_layer.Regression(regressors, target, held_regressors, held_target),
                hidden_layer.start(regressors.shape[1], self.settings.hidden, random),
                training.max_epochs,
                training.patience,
            )
            for target, held_target in zip(targets.T, held_targets.T, strict=True)
        ]
        self.parameters = torch.stack([solution.parameters for solution in solutions])
        _log(solutions, context)
        return sum(solution.validation_error for solution in solutions) / len(solutions)

    def increments(self, features: Tensor) -> Tensor:
        """Return each network's increment in its own unit."""
        regressors = self._regressors(features.to(self.parameters))
        scaled = [hidden_layer.predict(parameters, regressors) for parameters in self.parameters]
        return self.outputs.undo(torch.stack(scaled, dim=1))

    def tensors(self) -> dict[str, Tensor]:
        """Return weights and scaling."""
        return {"parameters": self.parameters} | scaler_tensors(self.inputs, self.outputs)

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over weights and scaling."""
        features, targets = len(self.layout.features), len(self.layout.targets)
        input_delays, output_delays = self.settings.delays()
        own_inputs = self.layout.input_features
        regressors = input_delays * own_inputs + output_delays * (features - own_inputs)
        count = hidden_layer.parameter_count(regressors, self.settings.hidden)
        shapes: dict[str, tuple[int, ...]] = {"parameters": (targets, count)}
        shapes |= scaler_shapes(features, targets)
        own = take_tensors(tensors, shapes)
        self.parameters = own["parameters"]
        self.inputs, self.outputs = scalers_of(own)

    def _all(self, examples: Examples) -> tuple[Tensor, Tensor]:
        windows, targets = examples.take(torch.arange(len(examples)))
        return self._regressors(windows), self.outputs.apply(targets)

    def _regressors(self, windows: Tensor) -> Tensor:
        """Return the delayed outputs and inputs of windows (batch, length, features), scaled, in a row."""
        input_delays, output_delays = self.settings.delays()
        scaled = self.inputs.apply(windows)
        border = scaled.shape[2] - self.layout.input_features
        outputs, inputs = scaled[:, -output_delays:, :border], scaled[:, -input_delays:, border:]
        return torch.cat([outputs.flatten(1), inputs.flatten(1)], dim=1)


def _log(solutions: list[Solution], context: FitContext) -> None:
    """Log the mean losses of all networks; one that has ended keeps its last."""
    for step in range(max(len(solution.errors) for solution in solutions)):
        errors = [
            solution.errors[min(step, len(solution.errors) - 1)] for solution in solutions if solution.errors
        ]
        train, held = (sum(values) / len(errors) for values in zip(*errors, strict=True))
        context.log({"train_loss": train, "validation_loss": held}, step)
