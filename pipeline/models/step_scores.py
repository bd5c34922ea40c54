"""One-step predictions of a model on held-out runs and their scores, for each target."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.evaluation import scored_starts
from simgap.models.windows import Series, gather

_CHUNK = 8192  # windows that are predicted together
UNCORRECTED = "_uncorrected"  # ends the names of the scores before a bias correction


@dataclass(frozen=True)
class NextValues:
    """One-step predictions of one target, in its unit.

    Attributes:
        known: present values, (windows,).
        predicted: next values as the model has them, (windows,).
        true: next values as recorded, (windows,).
    """

    known: Tensor
    predicted: Tensor
    true: Tensor

    @property
    def residuals(self) -> Tensor:
        """Recorded minus predicted, (windows,)."""
        return self.true - self.predicted


def next_values(
    model: DynamicsModel, machines: Mapping[str, Series], history: int = 0
) -> dict[str, NextValues]:
    """Return the one-step predictions on all windows, by target and machine.

    Args:
        model: to be scored.
        machines: series of held-out runs by the suffix that tells machines of one kind apart; "" holds all of them.
        history: samples before the first predicted one, at least; see `scored_starts`.

    Raises:
        InputError: when no segment is long enough.
    """
    return {
        f"{target}{name}": NextValues(*values)
        for name, series in machines.items()
        for target, *values in zip(model.layout.targets, *_all_windows(model, series, history), strict=True)
    }


def step_scores(
    values: Mapping[str, NextValues], uncorrected: Mapping[str, NextValues] | None = None
) -> dict[str, dict[str, float]]:
    """Return scores of one-step predictions.

    Scores cover the next value of a target and its increment. At high sampling rates the present value predicts most of
    the next value, and only the increment separates models.

    Args:
        values: by target.
        uncorrected: the same before a bias correction, if there was one.

    Returns:
        Target to {mse, mae, r_squared, increment_r_squared, correlation}: mean squared error in the target's unit
        squared, mean absolute error in its unit, coefficients of determination of value and increment, Pearson's
        correlation of predicted with true values. Those before a correction have names that end in `_uncorrected`.
        NaN where the true ones do not vary.
    """
    scores = {target: _scores(own) for target, own in values.items()}
    for target, before in (uncorrected or {}).items():
        scores[target] |= {f"{name}{UNCORRECTED}": score for name, score in _scores(before).items()}
    return scores


def _all_windows(model: DynamicsModel, series: Series, history: int) -> tuple[Tensor, Tensor, Tensor]:
    """Return the last known, predicted and true values of all windows, each (targets, windows)."""
    starts = scored_starts(model, series, 1, history)
    if not len(starts):
        remedy = "shorten it, or train.evaluation_history"
        raise InputError("no held-out segment is long enough", "model.sequence_length", remedy)
    pieces = [_windows(model, series, chunk) for chunk in starts.split(_CHUNK)]
    known, predicted, true = (torch.cat(part).T for part in zip(*pieces, strict=True))
    return known, predicted, true


def _windows(model: DynamicsModel, series: Series, starts: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return the targets' last known, predicted and true values, each (windows, targets)."""
    length = model.settings.sequence_length
    states = gather(series.states, starts, length + 1)
    predicted = model.predict(states[:, :length], gather(series.actions, starts, length))
    columns = [model.layout.states.index(target) for target in model.layout.targets]
    return states[:, -2, columns], predicted[:, columns], states[:, -1, columns]


def _scores(values: NextValues) -> dict[str, float]:
    known, predicted, true, residuals = values.known, values.predicted, values.true, values.residuals
    return {
        "mse": float(residuals.square().mean()),
        "mae": float(residuals.abs().mean()),
        "r_squared": _r_squared(predicted, true),
        "increment_r_squared": _r_squared(predicted - known, true - known),
        "correlation": _correlation(predicted, true),
    }


def _r_squared(predicted: Tensor, true: Tensor) -> float:
    scatter = (true - true.mean()).square().sum()
    return float(1 - (predicted - true).square().sum() / scatter) if scatter > 0 else math.nan


def _correlation(predicted: Tensor, true: Tensor) -> float:
    return float(torch.corrcoef(torch.stack([predicted, true]))[0, 1])
