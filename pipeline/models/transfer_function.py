"""Second-order transfer function of each axis: K / (1 + 2Tζs + T²s²), optionally with delay.

In state space, with x = (y, ẏ): ẋ₁ = x₂ and T²ẋ₂ = K·u(t − delay) − x₁ − 2Tζ·x₂. Inputs are held from each
sample to the next, so that its steps are exact.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np
import torch
from scipy.optimize import least_squares
from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.examples import one_step_loss
from simgap.models.restoring import take_tensors
from simgap.models.second_order import SecondOrder, responses
from simgap.models.settings import ModelSettings, Training
from simgap.models.windows import Series, gather

_PARAMETER_NAMES = tuple(entry.name for entry in fields(SecondOrder))
_START_TIMES = (2.0, 10.0, 50.0)  # time constants from which the fit is begun, samples
_SHORTEST_TIME, _LONGEST_TIME = 0.1, 1e4  # time constants, samples
_LEAST_DAMPED, _MOST_DAMPED = 1e-3, 1e3


@dataclass
class TransferFunctionSettings(ModelSettings):
    """Settings of the transfer functions."""

    name: str = "transfer_function"
    sequence_length: int = 10
    simulated: int = 100  # samples through which a simulation is fitted
    delayed: bool = False  # whether a delay is fitted, shorter than the window


class TransferFunctionModel(DynamicsModel):
    """One input and one output each; fitted by the error of simulations, in float64.

    A fit takes seconds: a killed one begins anew.
    """

    settings_class: ClassVar[type[ModelSettings]] = TransferFunctionSettings
    fits_residuals = False
    settings: TransferFunctionSettings

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Fit every axis to windows of the training series, each with its own initial state.

        Raises:
            InputError: when the layout has not one input for each target, or a series has no window.
        """
        self._require_pairs()
        length = self.settings.sequence_length
        examples, held = self.examples(train, "training"), self.examples(validation, "validation")
        steps = max(self.settings.simulated, length)
        starts = train.stretches(1, steps)
        if not len(starts):
            remedy = "shorten it, or record longer without gaps"
            raise InputError(f"no training segment holds {steps + 1} samples", "model.simulated", remedy)
        windows = gather(examples.features, starts, steps + 1).numpy()
        most = (length - 1) * self.time_step if self.settings.delayed else 0.0
        self.axes = [
            fit_axis(windows[:, :, output], windows[:, :-1, action], self.time_step, most)
            for output, action in zip(*self._columns(), strict=True)
        ]
        self._prepare()
        return one_step_loss(self.increments, examples, held)

    def increments(self, features: Tensor) -> Tensor:
        """Return the step of each axis from the state that fits its window best."""
        columns, actions = self._columns()
        outputs = features[..., columns].to(self.of_outputs)
        inputs = features[..., actions].to(self.of_inputs)
        following = (outputs * self.of_outputs).sum(1) + (inputs * self.of_inputs).sum(1)
        return following - outputs[:, -1]

    def tensors(self) -> dict[str, Tensor]:
        """Return gains, time constants s, damping ratios and delays s."""
        return {
            name: torch.tensor([getattr(axis, name) for axis in self.axes], dtype=torch.float64)
            for name in _PARAMETER_NAMES
        }

    def identified(self) -> dict[str, dict[str, float]]:
        """Return K, T in s and ζ of every axis, and its delay in s where one is fitted."""
        shown = {"gain": "K", "time_constant": "T", "damping": "ζ"}
        shown |= {"delay": "delay"} if self.settings.delayed else {}
        return {
            target: {short: float(getattr(axis, name)) for name, short in shown.items()}
            for target, axis in zip(self.layout.targets, self.axes, strict=True)
        }

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over what was fitted."""
        own = take_tensors(tensors, dict.fromkeys(_PARAMETER_NAMES, (len(self.layout.inputs),)))
        self.axes = [
            SecondOrder(*numbers)
            for numbers in torch.stack([own[name] for name in _PARAMETER_NAMES], dim=1).tolist()
        ]
        self._require_pairs()
        self._prepare()

    def _require_pairs(self) -> None:
        seen = self.layout.features
        paired = len(self.layout.inputs) == len(self.layout.targets)
        if not paired or {*self.layout.targets, *self.layout.inputs} - set(seen):
            remedy = "choose another model, or a layout such as train.layout=attitude"
            found = f"the layout {self.layout.kind!r} has not one seen input for each seen output"
            raise InputError(found, "model.name", remedy)

    def _columns(self) -> tuple[list[int], list[int]]:
        """Return the features that are outputs, and those that are their inputs."""
        place = self.layout.features.index
        return [place(name) for name in self.layout.targets], [place(name) for name in self.layout.inputs]

    def _prepare(self) -> None:
        """Work out how the next output depends on the outputs and inputs of a window, (length, axes) each."""
        weights = [next_output(axis, self.time_step, self.settings.sequence_length) for axis in self.axes]
        self.of_outputs, self.of_inputs = (
            torch.from_numpy(np.stack(part, axis=1)) for part in zip(*weights, strict=True)
        )


def next_output(axis: SecondOrder, time_step: float, length: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the weights (length,) of a window's outputs and inputs in the output that follows.

    The state at the window's beginning is the one that fits its outputs best.
    """
    free, forced = responses(axis, time_step, length)
    of_outputs = free[-1] @ np.linalg.pinv(free[:-1])
    return of_outputs, forced[-1] - of_outputs @ forced[:-1]


def fit_axis(
    outputs: np.ndarray, inputs: np.ndarray, time_step: float, most_delay: float = 0.0
) -> SecondOrder:
    """Fit a transfer function by the error of simulations, each from the initial state that suits it best.

    Args:
        outputs: (windows, steps + 1).
        inputs: (windows, steps).
        time_step: s.
        most_delay: longest delay, s; 0: none is fitted.
    """
    steps = inputs.shape[1]

    def axis_of(values: np.ndarray) -> SecondOrder:
        return SecondOrder(values[0], np.exp(values[1]), np.exp(values[2]), *values[3:])

    def residual(values: np.ndarray) -> np.ndarray:
        free, forced = responses(axis_of(values), time_step, steps)
        left = outputs - inputs @ forced.T
        basis, _ = np.linalg.qr(free)
        return np.asarray(left - left @ basis @ basis.T).ravel()

    free = 4 if most_delay > 0.0 else 3
    low = [-np.inf, np.log(_SHORTEST_TIME * time_step), np.log(_LEAST_DAMPED), 0.0][:free]
    high = [np.inf, np.log(_LONGEST_TIME * time_step), np.log(_MOST_DAMPED), most_delay][:free]
    starts = [[1.0, np.log(start * time_step), 0.0, 0.5 * most_delay][:free] for start in _START_TIMES]
    fits = [least_squares(residual, start, bounds=(low, high)) for start in starts]
    return axis_of(min(fits, key=lambda fit: fit.cost).x)
