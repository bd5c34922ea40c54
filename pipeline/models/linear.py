"""The linear model: ridge regression of the increment on the features of a window."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.examples import one_step_loss
from simgap.models.restoring import take_tensors
from simgap.models.scaling import Scaler
from simgap.models.settings import ModelSettings, Training
from simgap.models.windows import Series


@dataclass
class LinearSettings(ModelSettings):
    """Settings of the linear model."""

    name: str = "linear"
    ridge: float = 1e-8  # penalty per window on the coefficients of scaled features


class LinearModel(DynamicsModel):
    """Solved in closed form in float64."""

    settings_class: ClassVar[type[ModelSettings]] = LinearSettings
    settings: LinearSettings

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Solve the normal equations; the validation series only scores."""
        length = self.settings.sequence_length
        examples = self.examples(self.prepared(train), "training")
        held = self.examples(validation, "validation")
        self.scaler = Scaler.fit(self.regressors(examples.features), self.settings.scaling)
        columns = length * len(self.scaler.centre) + 1
        gram = torch.zeros(columns, columns, dtype=torch.float64)
        moment = torch.zeros(columns, examples.targets.shape[1], dtype=torch.float64)
        for windows, targets in examples.chunks():
            design = self._design(windows)
            gram += design.T @ design
            moment += design.T @ targets
        penalty = torch.full((columns,), self.settings.ridge * len(examples), dtype=torch.float64)
        penalty[-1] = 0.0  # the constant is free
        solution = torch.linalg.lstsq(gram + penalty.diag(), moment, driver="gelsd").solution
        # Laid out as storage does, which `contiguous` leaves alone of a single column: products round by layout.
        self.coefficients = solution.clone(memory_format=torch.contiguous_format)
        return one_step_loss(self.increments, examples, held)

    def increments(self, features: Tensor) -> Tensor:
        """Return the linear map of the window."""
        return self._design(features.to(torch.float64)) @ self.coefficients

    def tensors(self) -> dict[str, Tensor]:
        """Return coefficients and scaling."""
        return {"coefficients": self.coefficients, "centre": self.scaler.centre, "spread": self.scaler.spread}

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over coefficients and scaling."""
        width = self.regressors(torch.zeros(len(self.layout.features))).shape[-1]
        rows = self.settings.sequence_length * width + 1
        shapes = {
            "coefficients": (rows, len(self.layout.targets)),
            "centre": (width,),
            "spread": (width,),
        }
        own = take_tensors(tensors, shapes)
        self.coefficients = own["coefficients"]
        self.scaler = Scaler(own["centre"], own["spread"])

    def prepared(self, train: Series) -> Series:
        """Return the training series as the fit sees it: as it is."""
        return train

    def regressors(self, features: Tensor) -> Tensor:
        """Return what the model is linear in, (..., regressors), of features (..., features): the features."""
        return features

    def _design(self, windows: Tensor) -> Tensor:
        """Return scaled regressors in a row, and a constant, (batch, length · regressors + 1)."""
        flat = self.scaler.apply(self.regressors(windows)).flatten(1)
        return torch.cat([flat, torch.ones_like(flat[:, :1])], dim=1)
