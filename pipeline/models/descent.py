"""The steps of an optimiser, on the CPU or a GPU.

On a GPU the samples lie on it from the beginning, and a step is one CUDA graph: launching the many small kernels of
these networks takes longer than the kernels themselves.
"""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any

import pytorch_lightning as lightning
import torch
from torch import Tensor, nn

from simgap.models.settings import TrainedSettings
from simgap.simulation.captured import CapturedFunction

VALIDATION_LOSS = "validation_loss"


class Descent(lightning.LightningModule):
    """Adam on the loss of batches; each step is a CUDA graph where the device has them.

    Subclasses yield batches of tensors on the module's device.

    Attributes:
        improve: a step of the optimiser; returns the loss of the batch before it.
        judge: the loss of a batch of validation.
    """

    improve: Callable[..., Tensor]
    judge: Callable[..., Tensor]

    def __init__(self, network: nn.Module, settings: TrainedSettings, clip: float | None = None) -> None:
        """Note what is trained.

        Args:
            network: whose weights are learned.
            settings: learning rate and penalty.
            clip: greatest norm of a step's gradient; None: any.
        """
        super().__init__()
        self.automatic_optimization = False  # a graph holds the whole step
        self.network, self.settings, self.clip = network, settings, clip

    @abstractmethod
    def loss(self, *batch: Tensor) -> Tensor:
        """Return the loss of a batch."""

    def taught(self, *batch: Tensor) -> Tensor:
        """Return the loss of a batch in training, where it is another one."""
        return self.loss(*batch)

    @abstractmethod
    def place(self) -> None:
        """Move the samples to the module's device."""

    def on_fit_start(self) -> None:
        """Move everything to the device at once."""
        self.place()
        self.improve, self.judge = (
            self.captured() if self.device.type == "cuda" else (self._improve, self.loss)
        )

    def captured(self) -> tuple[CapturedFunction, CapturedFunction]:
        """Return a step of the optimiser, and the loss, as functions that a GPU replays."""
        return CapturedFunction(self._improve, self.device), CapturedFunction(self.loss, self.device)

    def forget(self) -> None:
        """Free the graphs of steps so far, where batches of other shapes follow."""
        if isinstance(self.improve, CapturedFunction):
            self.improve.forget()

    def on_train_start(self) -> None:
        """Keep the learning rate where a graph reads it, also that of a training taken up again."""
        if self.device.type == "cuda":
            for group in self._optimizer().param_groups:
                group["lr"] = torch.as_tensor(group["lr"], device=self.device)

    def training_step(self, batch: tuple[Tensor, ...], index: int) -> None:
        """Improve the weights by a batch."""
        loss = self.improve(*batch)
        self.log("train_loss", loss, on_step=False, on_epoch=True, batch_size=len(batch[0]))

    def validation_step(self, batch: tuple[Tensor, ...], index: int) -> None:
        """Log the loss of a batch."""
        loss = self.judge(*batch)
        self.log(VALIDATION_LOSS, loss, on_epoch=True, batch_size=len(batch[0]), prog_bar=True)

    def configure_optimizers(self) -> Any:
        """Return Adam with L2 penalty."""
        settings, on_gpu = self.settings, self.device.type == "cuda"
        return torch.optim.Adam(
            self.network.parameters(),
            lr=settings.learning_rate,
            weight_decay=settings.weight_decay,
            fused=on_gpu or None,
            capturable=on_gpu,
        )

    def _improve(self, *batch: Tensor) -> Tensor:
        optimizer = self._optimizer()
        optimizer.zero_grad()
        loss = self.taught(*batch)
        loss.backward()
        if self.clip is not None:
            nn.utils.clip_grad_norm_(self.network.parameters(), self.clip)
        optimizer.step()
        return loss.detach()

    def _optimizer(self) -> torch.optim.Optimizer:
        optimizer = self.optimizers(use_pl_optimizer=False)
        assert isinstance(optimizer, torch.optim.Optimizer)
        return optimizer
