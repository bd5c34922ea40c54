"""Callbacks of a training: best weights, checkpoints and progress."""

import logging
import math
import os
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytorch_lightning as lightning
from torch import Tensor, nn

_LAST = "last.ckpt"
_LINE_SECONDS = 5.0

_log = logging.getLogger("simgap")


class KeepBest(lightning.Callback):
    """Keeps the network's weights of the epoch with the lowest loss; they are part of a checkpoint.

    Attributes:
        loss: the lowest one.
        weights: the network's, on the CPU; None before the first finite loss.
    """

    def __init__(self, network: nn.Module, metric: str) -> None:
        self.network = network
        self.metric = metric
        self.loss = math.inf
        self.weights: dict[str, Tensor] | None = None

    def on_validation_end(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Compare the loss of the epoch with the lowest so far."""
        loss = float(trainer.callback_metrics[self.metric])
        if loss < self.loss:
            self.loss = loss
            weights = self.network.state_dict()
            self.weights = {name: tensor.detach().cpu().clone() for name, tensor in weights.items()}

    def state_dict(self) -> dict[str, Any]:
        """Return what a checkpoint keeps."""
        return {"loss": self.loss, "weights": self.weights}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Take over what a checkpoint kept."""
        self.loss, self.weights = state_dict["loss"], state_dict["weights"]


class ResumePoint(lightning.Callback):
    """Writes a checkpoint after every epoch, whole or not at all.

    None is written after the epoch that ends the training: one resumed from there would go on too long.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def existing(self) -> Path | None:
        """Return the checkpoint of a training that was interrupted."""
        path = self.folder / _LAST
        return path if path.is_file() else None

    def on_train_epoch_end(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Write beside the last checkpoint, then take its place."""
        if trainer.should_stop:
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        temporary = self.folder / f"{_LAST}.{os.getpid()}"
        trainer.save_checkpoint(temporary)
        temporary.replace(self.folder / _LAST)


class Tell(lightning.Callback):
    """Tells a listener the losses of every epoch and, where no terminal shows a bar, a log now and then."""

    def __init__(self, listener: Callable[[Mapping[str, float], int], None]) -> None:
        self.listener = listener
        self.due = time.monotonic() + _LINE_SECONDS

    def on_train_epoch_end(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Pass on all losses of the epoch."""
        losses = {name: float(value) for name, value in trainer.callback_metrics.items()}
        self.listener(losses, trainer.current_epoch)
        if time.monotonic() >= self.due and not sys.stderr.isatty():
            told = ", ".join(f"{name.replace('_', ' ')} {value:.4g}" for name, value in losses.items())
            _log.info("epoch %d of at most %d: %s", trainer.current_epoch + 1, trainer.max_epochs, told)
            self.due = time.monotonic() + _LINE_SECONDS
