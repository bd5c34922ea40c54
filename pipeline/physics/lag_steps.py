"""A compiled loop: lags that rise and fall with their own time constants, followed sample by sample."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True)
def starts_along(target: Array, decay_up: float, decay_down: float) -> Array:
    """Return where a lag is at the start of each step, (blocks, samples, series).

    Args:
        target: held over each step, (blocks, samples, series); at first the lag has settled on it.
        decay_up: share of a deviation that is left at the end of a step where it rises.
        decay_down: where it falls.
    """
    blocks, samples, series = target.shape
    starts = np.empty(target.shape)
    for block in range(blocks):
        for each in range(series):
            start = target[block, 0, each]
            for sample in range(samples):
                starts[block, sample, each] = start
                above = target[block, sample, each] - start
                start = target[block, sample, each] - above * (decay_up if above > 0.0 else decay_down)
    return starts
