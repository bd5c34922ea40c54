"""Radial basis functions on a linear model, chosen among the training samples by orthogonal least squares.

A network for every target, as Kantue & Pedro have one for every motor, or one that all targets share. Source of the
spread rule: Haykin 1999, "Neural networks: a comprehensive foundation", §5.13.
"""

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
    width: float | None = 2.0  # root mean square distance of scaled features; null: by the spread rule
    candidates: int = 1000  # training samples, drawn by the seed, that may become centres
    neurons: int = 200  # at most
    goal: float = 0.0  # share of the targets' variance that may stay unexplained
    ridge: float = 1e-6  # penalty per window on the coefficients
    shared: bool = True  # whether all targets share their centres; false: each has its own network


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
        self.width = torch.tensor(self._width(), dtype=torch.float64)
        gram, moment, energies = self._normal_equations(examples)
        linear = 1 + self.centres.shape[1]
        columns = (
            [list(range(len(energies)))] if self.settings.shared else [[n] for n in range(len(energies))]
        )
        choices = [
            choose(
                gram,
                moment[:, own],
                float(energies[own].sum()),
                linear + self.settings.neurons,
                self.settings.goal,
                linear,
            )
            for own in columns
        ]
        self._keep(choices, columns, linear)
        self.size = self._told(choices, linear, len(examples))
        context.log(self.size, 0)
        return one_step_loss(self.increments, examples, held)

    def increments(self, features: Tensor) -> Tensor:
        """Return the sum of the regressors in the targets' own units."""
        design = self._design(self._scaled(features.to(self.coefficients)))
        return self.outputs.undo(design @ self.coefficients)

    def tensors(self) -> dict[str, Tensor]:
        """Return centres, width, coefficients and scaling."""
        own = {"centres": self.centres, "width": self.width, "coefficients": self.coefficients}
        return own | scaler_tensors(self.inputs, self.outputs)

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over centres, coefficients and scaling."""
        features, targets = len(self.layout.features), len(self.layout.targets)
        columns, neurons = self.settings.sequence_length * features, len(tensors.get("centres", ()))
        shapes: dict[str, tuple[int, ...]] = {"centres": (neurons, columns), "width": ()}
        shapes["coefficients"] = (1 + columns + neurons, targets)
        shapes |= scaler_shapes(features, targets)
        own = take_tensors(tensors, shapes)
        self.centres, self.width, self.coefficients = own["centres"], own["width"], own["coefficients"]
        self.inputs, self.outputs = scalers_of(own)

    def _keep(self, choices: list[Choice], columns: list[list[int]], linear: int) -> None:
        """Keep the centres that some target chose; the first `linear` regressors have none."""
        weights = torch.zeros(linear + len(self.centres), len(self.layout.targets), dtype=torch.float64)
        for choice, own in zip(choices, columns, strict=True):
            weights[choice.order[:, None], torch.tensor(own)] = choice.weights
        radial = torch.cat([choice.order for choice in choices]).unique()
        radial = radial[radial >= linear]
        self.centres = self.centres[radial - linear]
        self.coefficients = torch.cat([weights[:linear], weights[radial]])

    def _told(self, choices: list[Choice], linear: int, samples: int) -> dict[str, float]:
        """Return neurons, achieved goal (the mean of several networks) and samples; see `size`."""
        neurons = [int((choice.order >= linear).sum()) for choice in choices]
        achieved = [float(choice.unexplained[-1]) for choice in choices]
        return {
            "neurons": sum(neurons) / len(neurons),
            "achieved_goal": sum(achieved) / len(achieved),
            "samples": float(samples),
        }

    def _width(self) -> float:
        """Return the width in force: by the spread rule the largest distance of centres over √(2·neurons)."""
        if self.settings.width is not None:
            return self.settings.width
        apart = float(torch.cdist(self.centres, self.centres).max()) / self.centres.shape[1] ** 0.5
        return max(apart, 1e-6) / (2.0 * max(self.settings.neurons, 1)) ** 0.5

    def _check(self) -> None:
        for key, least in (("width", 0.0), ("candidates", 1), ("neurons", 0), ("goal", 0.0), ("ridge", 0.0)):
            value = getattr(self.settings, key)
            if value is not None and (value < least or (key == "width" and value == 0.0)):
                raise InputError(f"is too small: {value}", f"model.{key}", "correct it")

    def _normal_equations(self, examples: Examples) -> tuple[Tensor, Tensor, Tensor]:
        """Return the regressors' Gram matrix with the penalty, their products with the targets, and those' energies."""
        columns = 1 + self.centres.shape[1] + len(self.centres)
        gram = torch.eye(columns, dtype=torch.float64) * (self.settings.ridge * len(examples))
        moment = torch.zeros(columns, len(self.layout.targets), dtype=torch.float64)
        energies = torch.zeros(len(self.layout.targets), dtype=torch.float64)
        for windows, targets in examples.chunks():
            design, scaled = self._design(self._scaled(windows)), self.outputs.apply(targets)
            gram += design.T @ design
            moment += design.T @ scaled
            energies += scaled.square().sum(0)
        return gram, moment, energies

    def _scaled(self, windows: Tensor) -> Tensor:
        return self.inputs.apply(windows).flatten(1)

    def _design(self, scaled: Tensor) -> Tensor:
        """Return a constant, the features and the radial functions, (batch, regressors)."""
        spread = 2.0 * self.width**2 * scaled.shape[1]
        radial = torch.exp(-torch.cdist(scaled, self.centres).square() / spread)
        return torch.cat([torch.ones_like(scaled[:, :1]), scaled, radial], dim=1)
