"""Training of a network with PyTorch Lightning: early stopping, best weights, resumption after a kill."""

import logging
import sys
from collections.abc import Iterator

import pytorch_lightning as lightning
import torch
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.accelerator import accelerator
from simgap.models.callbacks import KeepBest, ResumePoint, Tell
from simgap.models.contract import FitContext
from simgap.models.descent import VALIDATION_LOSS, Descent
from simgap.models.examples import Examples
from simgap.models.settings import TrainedSettings, Training

_VALIDATION_BATCH = 8192


class Batches:
    """Batches of windows in a given order, gathered from the series when they are asked for."""

    def __init__(self, examples: Examples, order: Tensor, size: int) -> None:
        self.examples = examples
        self.parts = order.split(size)

    def __len__(self) -> int:
        return len(self.parts)

    def __iter__(self) -> Iterator[tuple[Tensor, Tensor]]:
        """Yield windows (batch, length, features) and targets (batch, targets)."""
        return map(self.examples.take, self.parts)


class Regression(Descent):
    """One-step mean squared error of a network on scaled windows."""

    def __init__(
        self,
        network: nn.Module,
        train: Examples,
        validation: Examples,
        settings: TrainedSettings,
        size: int,
        seed: int,
    ) -> None:
        super().__init__(network, settings)
        self.train_examples = train
        self.validation_examples = validation
        self.size = size
        self.seed = seed

    def train_dataloader(self) -> Batches:
        """Shuffle anew by seed and epoch, so that a resumed epoch is the one that was interrupted."""
        generator = torch.Generator().manual_seed(self._epoch_seed())
        order = torch.randperm(len(self.train_examples), generator=generator)
        # Batch normalisation needs two samples: a last batch of one is left out.
        if len(order) > 1 and len(order) % self.size == 1:
            order = order[:-1]
        return Batches(self.train_examples, order, self.size)

    def val_dataloader(self) -> Batches:
        """Go through all validation windows in order."""
        order = torch.arange(len(self.validation_examples))
        return Batches(self.validation_examples, order, _VALIDATION_BATCH)

    def on_train_epoch_start(self) -> None:
        """Let dropout depend on seed and epoch only."""
        torch.manual_seed(self._epoch_seed())

    def place(self) -> None:
        """Move the windows."""
        self.train_examples, self.validation_examples = (
            examples.to(self.device) for examples in (self.train_examples, self.validation_examples)
        )

    def loss(self, *batch: Tensor) -> Tensor:
        """Return the mean squared error of windows and targets."""
        windows, targets = batch
        return nn.functional.mse_loss(self.network(windows), targets)

    def _epoch_seed(self) -> int:
        return (self.seed * 100_003 + self.current_epoch) % 2**63


def train_network(
    network: nn.Module,
    train: Examples,
    validation: Examples,
    settings: TrainedSettings,
    training: Training,
    context: FitContext,
) -> float:
    """Train a network in place and return its lowest validation loss, whose weights it is left with.

    Args:
        network: from (batch, length, features) to (batch, targets), float32.
        train: scaled windows.
        validation: scaled windows of other runs.
        settings: learning rate and penalty.
        training: epochs, patience, batch size.
        context: seed, checkpoint folder, listener.

    Raises:
        InputError: when the loss is not finite from the beginning.
    """
    module = Regression(network, train, validation, settings, training.batch_size, context.seed)
    return train_module(module, network, training, context)


def train_module(
    module: lightning.LightningModule,
    network: nn.Module,
    training: Training,
    context: FitContext,
    device: torch.device | None = None,
) -> float:
    """Train with early stopping, best weights and resumption after a kill.

    Args:
        module: logs `VALIDATION_LOSS`.
        network: that it trains, left with the weights of the lowest loss.
        training: epochs and patience.
        context: checkpoint folder, listener.
        device: of the training; None: the accelerator. The network comes back to the CPU.

    Raises:
        InputError: when the loss is not finite from the beginning.
    """
    _silence_lightning()
    # It would take more kernels, and change no result.
    torch.utils.deterministic.fill_uninitialized_memory = False  # type: ignore[attr-defined]
    best = KeepBest(network, VALIDATION_LOSS)
    # Decided right after validation, so that at the end of the epoch it is known whether to write a resume point.
    stopping = lightning.callbacks.EarlyStopping(
        VALIDATION_LOSS, patience=training.patience, mode="min", check_on_train_epoch_end=False
    )
    callbacks: list[lightning.Callback] = [stopping, best, Tell(context.log)]
    resume = None
    if context.checkpoint is not None:
        point = ResumePoint(context.checkpoint)
        callbacks.append(point)
        resume = point.existing()
    trainer = lightning.Trainer(
        max_epochs=training.max_epochs,
        callbacks=callbacks,
        logger=False,
        enable_checkpointing=False,
        enable_model_summary=False,
        enable_progress_bar=sys.stderr.isatty(),
        num_sanity_val_steps=0,
        reload_dataloaders_every_n_epochs=1,
        deterministic=True,
        accelerator=(device or accelerator()).type,
        devices=1,
    )
    trainer.fit(module, ckpt_path=resume, weights_only=True)
    network.cpu()
    if best.weights is None:
        raise InputError("the training diverges", "model.learning_rate", "lower it")
    network.load_state_dict(best.weights)
    return best.loss


def _silence_lightning() -> None:
    """Keep Lightning from telling about hardware and its own products."""
    for name in ("pytorch_lightning", "lightning.pytorch", "pytorch_lightning.utilities.rank_zero"):
        logging.getLogger(name).setLevel(logging.ERROR)
