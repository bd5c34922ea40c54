"""Where networks are trained, and models scored."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch

from simgap.models.contract import DynamicsModel


def accelerator() -> torch.device:
    """Return the GPU where CUDA has one, else the CPU."""
    return torch.device("cuda" if torch.cuda.is_available() else "cpu")


@contextmanager
def accelerated(model: DynamicsModel) -> Iterator[None]:
    """Let a model predict on the accelerator, and bring it back to the CPU."""
    model.to(accelerator())
    try:
        yield
    finally:
        model.to(torch.device("cpu"))
