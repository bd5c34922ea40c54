"""One seed for every source of random numbers."""

import random
import sys


def seed_everything(seed: int) -> None:
    """Seed Python, numpy and, where it is loaded, torch.

    The wrapper calls this before a stage starts; a stage that imports torch only later calls it again then.
    """
    import numpy

    random.seed(seed)
    numpy.random.seed(seed % 2**32)  # noqa: NPY002 - libraries still draw from the global generator
    if "torch" in sys.modules:
        sys.modules["torch"].manual_seed(seed)
