"""Rollout errors of a model on held-out runs, with persistence as the reference."""

from collections.abc import Sequence

from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.windows import Series, evenly, gather

Errors = dict[str, dict[str, dict[str, float]]]


def rollout_errors(
    model: DynamicsModel, series: Series, horizons: Sequence[int], most: int, history: int = 0
) -> Errors:
    """Return mean errors after some numbers of steps: of the model, and of the last known state kept.

    All horizons are scored on the same windows, those of the longest one.

    Args:
        model: to be scored.
        series: of held-out runs.
        horizons: numbers of steps, rising order not needed.
        most: windows to score at most, spread evenly.
        history: samples before the first predicted one, at least; see `scored_starts`.

    Returns:
        Quantity to `hN` to {model, naive}, and to `sum`: the errors of all steps up to the longest horizon, added.
        NaN or infinity where a rollout has run away. Horizons longer than every segment are left out.

    Raises:
        InputError: when no horizon is possible or one is not positive.
    """
    if any(horizon < 1 for horizon in horizons):
        raise InputError("a horizon is at least one step", "train.horizons", "give positive numbers")
    possible = [steps for steps in sorted(set(horizons)) if len(scored_starts(model, series, steps, history))]
    if not possible:
        remedy = "shorten them, or train.evaluation_history"
        raise InputError("no held-out segment is long enough", "train.horizons", remedy)
    starts = evenly(scored_starts(model, series, possible[-1], history), most)
    errors = window_errors(model, series, starts, possible[-1])
    by_step = {name: {whose: own.mean(0) for whose, own in pair.items()} for name, pair in errors.items()}
    return {
        quantity: {
            f"h{steps}": {whose: float(error[steps - 1]) for whose, error in pair.items()}
            for steps in possible
        }
        | {"sum": {whose: float(error.sum()) for whose, error in pair.items()}}
        for quantity, pair in by_step.items()
    }


def scored_starts(model: DynamicsModel, series: Series, steps: int, history: int = 0) -> Tensor:
    """Return the first samples of the windows that are followed by so many steps, (windows,).

    The first predicted sample is the `history`-th of its segment or a later one: models whose windows are no longer
    than that are scored on the same samples.
    """
    length = model.settings.sequence_length
    skipped = max(history - length, 0)
    return series.starts(skipped + length + steps) + skipped


def window_errors(
    model: DynamicsModel, series: Series, starts: Tensor, steps: int
) -> dict[str, dict[str, Tensor]]:
    """Return by quantity the errors (windows, steps) of the `model`, and `naive` of the last known state kept."""
    length = model.settings.sequence_length
    states = gather(series.states, starts, length + steps)
    actions = gather(series.actions, starts, length + steps - 1)
    known, true = states[:, :length], states[:, length:]
    own = model.layout.errors(model.rollout(known, actions), true)
    naive = model.layout.errors(known[:, -1:].expand_as(true), true)
    return {name: {"model": own[name], "naive": naive[name]} for name in own}
