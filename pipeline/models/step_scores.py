"""One-step scores of a model on held-out runs, for each target."""

import math

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.evaluation import scored_starts
from simgap.models.windows import Series, gather

_CHUNK = 8192  # windows that are predicted together


def step_scores(model: DynamicsModel, series: Series, history: int = 0) -> dict[str, dict[str, float]]:
    """Return scores of one-step predictions on all windows.

    Scores cover the next value of a target and its increment. At high sampling rates the present value predicts most of
    the next value, and only the increment separates models.

    Args:
        model: to be scored.
        series: of held-out runs.
        history: samples before the first predicted one, at least; see `scored_starts`.

    Returns:
        Target to {mse, mae, r_squared, increment_r_squared, correlation}: mean squared error in the target's unit
        squared, mean absolute error in its unit, coefficients of determination of value and increment, Pearson's
        correlation of predicted with true values.
        NaN where the true ones do not vary.

    Raises:
        InputError: when no segment is long enough.
    """
    starts = scored_starts(model, series, 1, history)
    if not len(starts):
        remedy = "shorten it, or train.evaluation_history"
        raise InputError("no held-out segment is long enough", "model.sequence_length", remedy)
    pieces = [_next_values(model, series, chunk) for chunk in starts.split(_CHUNK)]
    before, predicted, true = (torch.cat(part) for part in zip(*pieces, strict=True))
    return {
        target: {
            "mse": float((predicted[:, column] - true[:, column]).square().mean()),
            "mae": float((predicted[:, column] - true[:, column]).abs().mean()),
            "r_squared": _r_squared(predicted[:, column], true[:, column]),
            "increment_r_squared": _r_squared(
                *(value[:, column] - before[:, column] for value in (predicted, true))
            ),
            "correlation": _correlation(predicted[:, column], true[:, column]),
        }
        for column, target in enumerate(model.layout.targets)
    }


def _next_values(model: DynamicsModel, series: Series, starts: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return the targets' last known, predicted and true values, each (windows, targets)."""
    length = model.settings.sequence_length
    states = gather(series.states, starts, length + 1)
    predicted = model.predict(states[:, :length], gather(series.actions, starts, length))
    columns = [model.layout.states.index(target) for target in model.layout.targets]
    return states[:, -2, columns], predicted[:, columns], states[:, -1, columns]


def _r_squared(predicted: Tensor, true: Tensor) -> float:
    scatter = (true - true.mean()).square().sum()
    return float(1 - (predicted - true).square().sum() / scatter) if scatter > 0 else math.nan


def _correlation(predicted: Tensor, true: Tensor) -> float:
    return float(torch.corrcoef(torch.stack([predicted, true]))[0, 1])
