"""The predictions of the next step on every window of a series, each from recorded samples alone."""

import torch
from torch import Tensor

from pipeline.models.contract import DynamicsModel
from pipeline.models.examples import CHUNK, Examples


@torch.no_grad()
def one_step_increments(model: DynamicsModel, examples: Examples) -> tuple[Tensor, Tensor]:
    """Return predicted and true increments, (windows, targets) each."""
    pairs = [
        (model.increments(windows).to(targets.dtype), targets)
        for windows, targets in map(examples.take, torch.arange(len(examples)).split(CHUNK))
    ]
    predicted, true = zip(*pairs, strict=True)
    return torch.cat(predicted), torch.cat(true)


def one_step_loss(model: DynamicsModel, examples: Examples, spread: Tensor) -> float:
    """Return the mean squared error of the increments, each over its spread (targets,)."""
    predicted, true = one_step_increments(model, examples)
    return float(((predicted - true) / spread).square().mean())
