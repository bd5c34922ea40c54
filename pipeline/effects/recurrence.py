"""A linear recurrence along recorded blocks, by a parallel prefix scan."""

import torch

from simgap.physics.shapes import Series


def accumulated(decay: Series, gained: Series) -> Series:
    """Return y of y[k] = decay[k] · y[k−1] + gained[k] for all samples, in log₂(samples) passes.

    Source: Blelloch 1990, Prefix sums and their applications, §1.4.

    Args:
        decay: (blocks, samples, ...).
        gained: of the same shape; its first sample is where y starts.
    """
    reach = 1
    while reach < gained.shape[1]:
        longer = gained[:, reach:] + decay[:, reach:] * gained[:, :-reach]
        gained = torch.cat([gained[:, :reach], longer], dim=1)
        decay = torch.cat([decay[:, :reach], decay[:, reach:] * decay[:, :-reach]], dim=1)
        reach *= 2
    return gained
