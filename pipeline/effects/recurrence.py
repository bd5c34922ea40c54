"""Linear recurrences along recorded blocks, by a parallel prefix scan."""

import torch
from jaxtyping import Float
from torch import Tensor

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


def accumulated_states(
    transition: Float[Tensor, "states states"], gained: Float[Tensor, "blocks samples states"]
) -> Float[Tensor, "blocks samples states"]:
    """Return x of x[k] = transition · x[k−1] + gained[k] for all samples, in log₂(samples) passes.

    Args:
        transition: the same for every sample, (states, states).
        gained: (blocks, samples, states); its first sample is where x starts.
    """
    reach = 1
    while reach < gained.shape[1]:
        gained = torch.cat([gained[:, :reach], gained[:, reach:] + gained[:, :-reach] @ transition.mT], dim=1)
        transition = transition @ transition
        reach *= 2
    return gained
