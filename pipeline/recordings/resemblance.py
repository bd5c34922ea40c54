"""Distances between runs of a recording: by mean, spread and step size of their channels."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.recordings.runs import stretches_of_runs

_NO_CHANNELS = ("run", "t", "segment", "filled")
_STILL_SHARE = 1e-4  # of a channel's spread, below which it counts as still


def distances_of(frame: pd.DataFrame) -> NDArray[np.float64]:
    """Return the distances between runs, (runs, runs), in the order in which they appear.

    Compared are the mean of every channel, and the logarithms of its spread and of that of its steps between samples,
    each over its deviation from run to run; a distance is the root of their mean square.

    Args:
        frame: of a recording; channels that some run lacks do not count.
    """
    names, _ = stretches_of_runs(frame["run"])
    if len(set(names)) == 1:
        return np.zeros((1, 1))
    numbers = frame.drop(columns=list(_NO_CHANNELS), errors="ignore").select_dtypes("number")
    complete = [name for name in numbers if np.isfinite(numbers[name]).all()]
    run = pd.factorize(frame["run"])[0]  # numbers are quicker to group by than names
    scaled = numbers[complete] / numbers[complete].std().replace(0.0, 1.0).fillna(1.0)
    runs = scaled.groupby(run, sort=False)
    steps = runs.diff().groupby(run, sort=False)
    sizes = [np.log(part.std().fillna(0.0).clip(lower=_STILL_SHARE).to_numpy()) for part in (runs, steps)]
    traits = np.concatenate([runs.mean().to_numpy(), *sizes], axis=1)
    traits = traits - traits.mean(0)
    told = traits.std(0) > _STILL_SHARE
    traits = traits[:, told] / traits[:, told].std(0)
    apart = traits[:, None] - traits[None]
    return np.sqrt(np.square(apart).sum(-1) / max(int(told.sum()), 1))
