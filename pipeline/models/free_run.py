"""Free-run simulation of a model in parallel form: recorded inputs, with its own outputs fed back."""

import numpy as np
import pandas as pd
import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.windows import Series, gather


def free_run_scores(model: DynamicsModel, series: Series, duration: float) -> dict[str, dict[str, float]]:
    """Return mean squared error and correlation of every state over stretches that follow on each other.

    Args:
        model: to be scored.
        series: of held-out runs.
        duration: of a stretch, s; the window before it is known.

    Returns:
        State to `mse`, in its squared unit, and `correlation`; NaN where a run has run away.

    Raises:
        InputError: when no segment is that long.
    """
    predicted, true = (part.flatten(0, 1) for part in _free_runs(model, series, duration))
    return {
        name: {
            "mse": float((predicted[:, index] - true[:, index]).square().mean()),
            "correlation": _correlation(predicted[:, index], true[:, index]),
        }
        for index, name in enumerate(model.layout.states)
    }


def free_run_traces(model: DynamicsModel, series: Series, duration: float) -> pd.DataFrame:
    """Return the first of the stretches that `free_run_scores` scores, sample by sample.

    Args:
        model: to be simulated.
        series: of held-out runs.
        duration: of a stretch, s.

    Returns:
        Columns t (s, from the last known sample), state, measured and modelled (in the state's unit).

    Raises:
        InputError: when no segment is that long.
    """
    predicted, true = (part[0].numpy() for part in _free_runs(model, series, duration))
    time = series.time_step * np.arange(1, len(true) + 1)
    pieces = [
        pd.DataFrame({"t": time, "state": name, "measured": true[:, index], "modelled": predicted[:, index]})
        for index, name in enumerate(model.layout.states)
    ]
    return pd.concat(pieces, ignore_index=True)


def _free_runs(model: DynamicsModel, series: Series, duration: float) -> tuple[Tensor, Tensor]:
    """Return predicted and recorded states of all stretches, (stretches, steps, states) each."""
    steps, length = round(duration / series.time_step), model.settings.sequence_length
    starts = series.stretches(length, steps)
    if steps < 1 or not len(starts):
        raise InputError(f"no held-out segment lasts {duration} s", "train.free_run", "shorten it")
    states = gather(series.states, starts, length + steps)
    actions = gather(series.actions, starts, length + steps - 1)
    return model.rollout(states[:, :length], actions), states[:, length:]


def _correlation(one: Tensor, other: Tensor) -> float:
    return float(torch.corrcoef(torch.stack([one, other]))[0, 1])
