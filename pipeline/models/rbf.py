"""Radial basis functions on a linear model, chosen among the training samples by orthogonal least squares."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.examples import Examples, one_step_loss
from simgap.models.orthogonal_least_squares import Choice, choose
from simgap.models.restoring import take_tensors
from simgap.models.scaling import Scaler, scaler_shapes, scaler_tensors, scalers_of
from simgap.models.settings import ModelSettings, Training
from simgap.models.windows import Series


@dataclass
class RadialBasisSettings(ModelSettings):
    """Settings of the radial basis network."""

    name: str = "rbf"
    width: float = 2.0  # of the functions: root mean square distance of scaled features
    candidates: int = 1000  # training samples, drawn by the seed, that may become centres
    neurons: int = 200  # at most
    goal: float = 0.0  # share of the targets' variance that may stay unexplained
    ridge: float = 1e-6  # penalty per window on the coefficients


class RadialBasisModel(DynamicsModel):
    """Solved in float64: a constant, the scaled features and Gaussian functions around chosen samples.

    A fit takes seconds to a minute: a killed one begins anew.
    """

    settings_class: ClassVar[type[ModelSettings]] = RadialBasisSettings
    settings: RadialBasisSettings

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Choose centres until the goal is reached; the validation series only scores.

        Raises:
            InputError: when a setting makes no network, or a series has no window.
        """
        self._check()
        context = context or FitContext()
        examples, held = self.examples(train, "training"), self.examples(validation, "validation")
        self.inputs = Scaler.fit(examples.features, self.settings.scaling)
        self.outputs = Scaler.fit(examples.targets[examples.seen()], "standard")
        drawn = torch.randperm(len(examples), generator=torch.Generator().manual_seed(context.seed))
        self.centres = self._scaled(examples.take(drawn[: self.settings.candidates])[0])
        gram, moment, energy = self._normal_equations(examples)
        linear = 1 + self.centres.shape[1]
        choice = choose(gram, moment, energy, linear + self.settings.neurons, self.settings.goal, linear)
        self._keep(choice, linear)
        self.size = {"neurons": float(len(self.centres)), "samples": float(len(examples))}
        context.log(self.size, 0)
        return one_step_loss(self.increments, examples, held)

    def increments(self, features: Tensor) -> Tensor:
        """Return the sum of the regressors in the targets' own units."""
        design = self._design(self._scaled(features.to(self.coefficients)))
        return self.outputs.undo(design @ self.coefficients)

    def tensors(self) -> dict[str, Tensor]:
        """Return centres, coefficients and scaling."""
        return {"centres": self.centres, "coefficients": self.coefficients} | scaler_tensors(
            self.inputs, self.outputs
        )

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over centres, coefficients and scaling."""
        features, targets = len(self.layout.features), len(self.layout.targets)
        columns, neurons = self.settings.sequence_length * features, len(tensors.get("centres", ()))
        shapes: dict[str, tuple[int, ...]] = {"centres": (neurons, columns)}
        shapes["coefficients"] = (1 + columns + neurons, targets)
        shapes |= scaler_shapes(features, targets)
        own = take_tensors(tensors, shapes)
        self.centres, self.coefficients = own["centres"], own["coefficients"]
        self.inputs, self.outputs = scalers_of(own)

    def _keep(self, choice: Choice, linear: int) -> None:
        """Keep the chosen centres; the first `linear` regressors have none."""
        radial = choice.order >= linear
        self.centres = self.centres[choice.order[radial] - linear]
        below = torch.zeros(linear, len(self.layout.targets), dtype=torch.float64)
        below[choice.order[~radial]] = choice.weights[~radial]
        self.coefficients = torch.cat([below, choice.weights[radial]])

    def _check(self) -> None:
        for key, least in (("width", 0.0), ("candidates", 1), ("neurons", 0), ("goal", 0.0), ("ridge", 0.0)):
            value = getattr(self.settings, key)
            if value < least or (key == "width" and value == 0.0):
                raise InputError(f"is too small: {value}", f"model.{key}", "correct it")

    def _normal_equations(self, examples: Examples) -> tuple[Tensor, Tensor, float]:
        """Return the regressors' Gram matrix with the penalty, their products with the targets, and those' energy."""
        columns = 1 + self.centres.shape[1] + len(self.centres)
        gram = torch.eye(columns, dtype=torch.float64) * (self.settings.ridge * len(examples))
        moment = torch.zeros(columns, len(self.layout.targets), dtype=torch.float64)
        energy = 0.0
        for windows, targets in examples.chunks():
            design, scaled = self._design(self._scaled(windows)), self.outputs.apply(targets)
            gram += design.T @ design
            moment += design.T @ scaled
            energy += float(scaled.square().sum())
        return gram, moment, energy

    def _scaled(self, windows: Tensor) -> Tensor:
        return self.inputs.apply(windows).flatten(1)

    def _design(self, scaled: Tensor) -> Tensor:
        """Return a constant, the features and the radial functions, (batch, regressors)."""
        spread = 2.0 * self.settings.width**2 * scaled.shape[1]
        radial = torch.exp(-torch.cdist(scaled, self.centres).square() / spread)
        return torch.cat([torch.ones_like(scaled[:, :1]), scaled, radial], dim=1)
