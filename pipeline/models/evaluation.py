"""Errors of a model on runs it has not seen, against the assumption that nothing changes."""

from collections.abc import Sequence

import torch
from torch import Tensor

from pipeline.errors import InputError
from pipeline.models.contract import DynamicsModel
from pipeline.models.windows import Series, gather

Errors = dict[str, dict[str, dict[str, float]]]


def rollout_errors(model: DynamicsModel, series: Series, horizons: Sequence[int], most: int) -> Errors:
    """Return mean errors after some numbers of steps: of the model, and of the last known state kept.

    Args:
        model: to be scored.
        series: of held-out runs.
        horizons: numbers of steps, rising order not needed.
        most: windows to score at most, spread evenly.

    Returns:
        Quantity to `hN` to {model, naive}; NaN or infinity where a rollout has run away. Horizons longer than
        every segment are left out.

    Raises:
        InputError: when no horizon is possible or one is not positive.
    """
    if any(horizon < 1 for horizon in horizons):
        raise InputError("a horizon is at least one step", "train.horizons", "give positive numbers")
    errors: Errors = {}
    for horizon in sorted(set(horizons)):
        for quantity, pair in _errors_at(model, series, horizon, most).items():
            errors.setdefault(quantity, {})[f"h{horizon}"] = pair
    if not errors:
        raise InputError("no held-out segment is long enough", "train.horizons", "shorten them")
    return errors


def _errors_at(model: DynamicsModel, series: Series, horizon: int, most: int) -> dict[str, dict[str, float]]:
    length = model.settings.sequence_length
    starts = series.starts(length + horizon)
    if not len(starts):
        return {}
    if len(starts) > most:
        starts = starts[torch.linspace(0, len(starts) - 1, most, dtype=torch.float64).round().long()]
    states = gather(series.states, starts, length + horizon)
    actions = gather(series.actions, starts, length + horizon - 1)
    known, true = states[:, :length], states[:, -1]
    predicted = model.rollout(known, actions)[:, -1]
    own, naive = model.layout.errors(predicted, true), model.layout.errors(known[:, -1], true)
    return {name: {"model": _mean(own[name]), "naive": _mean(naive[name])} for name in own}


def _mean(values: Tensor) -> float:
    return float(values.mean())
