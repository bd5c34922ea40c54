"""Distribution of a model's rollout errors over the windows, at several horizons."""

from collections.abc import Sequence

import torch

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.evaluation import scored_starts, window_errors
from simgap.models.windows import Series, evenly


def error_quantiles(
    model: DynamicsModel,
    series: Series,
    horizons: Sequence[int],
    quantiles: Sequence[float],
    most: int,
    history: int = 0,
) -> dict[str, dict[str, dict[str, float]]]:
    """Return quantiles of the errors on the windows that `rollout_errors` takes the mean of.

    Args:
        model: to be scored.
        series: of held-out runs, with a window that the longest horizon follows.
        horizons: numbers of steps.
        quantiles: shares of the windows, from 0 to 1.
        most: windows to score at most, spread evenly.
        history: samples before the first predicted one, at least.

    Returns:
        Quantity to `hN` to `qP`, the error in the quantity's unit that P percent of the windows stay below.

    Raises:
        InputError: when a quantile is no share, or no segment is long enough.
    """
    if any(not 0.0 <= share <= 1.0 for share in quantiles):
        raise InputError("a quantile is a share from 0 to 1", "train.quantiles", "correct the list")
    starts = evenly(scored_starts(model, series, max(horizons), history), most)
    if not len(starts):
        raise InputError("no held-out segment is long enough", "train.horizons", "shorten them")
    shares = torch.tensor(list(quantiles), dtype=torch.float64)
    names = [f"q{100 * share:g}" for share in quantiles]
    return {
        quantity: {
            f"h{steps}": dict(
                zip(names, torch.quantile(errors["model"][:, steps - 1], shares).tolist(), strict=True)
            )
            for steps in horizons
        }
        for quantity, errors in window_errors(model, series, starts, max(horizons)).items()
    }
