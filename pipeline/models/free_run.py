"""Free-run simulation of a model in parallel form: recorded inputs, with its own outputs fed back."""

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
    steps, length = round(duration / series.time_step), model.settings.sequence_length
    starts = series.stretches(length, steps)
    if steps < 1 or not len(starts):
        raise InputError(f"no held-out segment lasts {duration} s", "train.free_run", "shorten it")
    states = gather(series.states, starts, length + steps)
    actions = gather(series.actions, starts, length + steps - 1)
    predicted = model.rollout(states[:, :length], actions).flatten(0, 1)
    true = states[:, length:].flatten(0, 1)
    return {
        name: {
            "mse": float((predicted[:, index] - true[:, index]).square().mean()),
            "correlation": _correlation(predicted[:, index], true[:, index]),
        }
        for index, name in enumerate(model.layout.states)
    }


def _correlation(one: Tensor, other: Tensor) -> float:
    return float(torch.corrcoef(torch.stack([one, other]))[0, 1])
