"""Training through open-loop predictions, which penalises errors that grow from step to step.

Source: Mohajerin, Mozifian & Waslander 2018, "Deep learning a quadrotor dynamic model for multi-step prediction".
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Protocol, runtime_checkable

import pytorch_lightning as lightning
import torch
from pytorch_lightning.utilities.types import OptimizerLRSchedulerConfig
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.contract import FitContext, Teacher
from simgap.models.layout import Layout
from simgap.models.settings import TrainedSettings, Training
from simgap.models.training import VALIDATION_LOSS, train_module
from simgap.models.windows import Series, evenly, gather

_VALIDATION_WINDOWS = 2048  # evenly over the validation runs
_THINNING = 10  # windows of the training runs to one that an epoch sees: neighbours say nearly the same
_USUAL_WINDOWS = 4096  # from which the usual change of every quantity is taken


@runtime_checkable
class Unrolled(Protocol):
    """What is trained here: a network in a model that predicts many steps with it."""

    @property
    def network(self) -> nn.Module:
        """Whose weights are learned."""

    @property
    def layout(self) -> Layout:
        """Of what is predicted."""

    @property
    def settings(self) -> TrainedSettings:
        """Of the model."""

    def unroll(self, states: Tensor, actions: Tensor, teacher: Teacher | None = None) -> Tensor:
        """Return what `DynamicsModel.unroll` does, with its derivatives."""


class Stretches:
    """Batches of recorded states and inputs, gathered from the series when they are asked for."""

    def __init__(self, series: Series, starts: Tensor, length: int, size: int) -> None:
        self.series, self.parts, self.length = series, starts.split(size), length

    def __len__(self) -> int:
        return len(self.parts)

    def __iter__(self) -> Iterator[tuple[Tensor, Tensor]]:
        """Yield states (batch, length, states) and inputs (batch, length − 1, inputs)."""
        for starts in self.parts:
            yield (
                gather(self.series.states, starts, self.length),
                gather(self.series.actions, starts, self.length - 1),
            )


class RolloutRegression(lightning.LightningModule):
    """Mean error of open-loop predictions, each quantity and step over its usual change until then.

    The error is not squared, because a few diverging windows would dominate a squared error.

    With teacher forcing there is a prediction for each group of quantities, to which the others are given. Validation
    gives none.

    Dropout and batch normalisation run as in prediction, because the outputs are fed back.
    """

    def __init__(
        self, model: Unrolled, train: Series, validation: Series, training: Training, seed: int
    ) -> None:
        super().__init__()
        self.model, self.network = model, model.network
        self.train_series, self.validation_series = _single(train), _single(validation)
        self.steps, self.size, self.seed = training.steps, training.batch_size, seed
        self.epochs, self.growing = training.max_epochs, round(training.growth * training.max_epochs)
        self.known = model.settings.sequence_length
        self.lessons = lessons(model.layout) if training.teacher_forcing else []
        self.usual = usual_changes(model.layout, self.train_series, training.steps)

    def train_dataloader(self) -> Stretches:
        """Shuffle anew by seed and epoch, so that a resumed epoch is the one that was interrupted."""
        length = self.known + self.horizon()
        starts = _starts(self.train_series, length, "training")
        generator = torch.Generator().manual_seed((self.seed * 100_003 + self.current_epoch) % 2**63)
        order = torch.randperm(len(starts), generator=generator)
        kept = max(len(order) // _THINNING, self.size)
        return Stretches(self.train_series, starts[order[:kept]], length, self.size)

    def val_dataloader(self) -> Stretches:
        """Go through windows that are spread evenly over the validation runs."""
        length = self.known + self.steps
        starts = _starts(self.validation_series, length, "validation")
        return Stretches(
            self.validation_series, evenly(starts, _VALIDATION_WINDOWS), length, _VALIDATION_WINDOWS
        )

    def horizon(self) -> int:
        """Return the steps that are predicted in this epoch, fewer in the first ones where the horizon grows."""
        return math.ceil(self.steps * min((self.current_epoch + 1) / (self.growing + 1), 1.0))

    def on_train_epoch_start(self) -> None:
        """Keep the network as it is in prediction."""
        self.network.eval()

    def training_step(self, batch: tuple[Tensor, Tensor], index: int) -> Tensor:
        """Return the loss of a batch."""
        loss = self._taught(batch) if self.lessons else self._loss(batch)
        self.log("train_loss", loss, on_step=False, on_epoch=True, batch_size=len(batch[0]))
        return loss

    def validation_step(self, batch: tuple[Tensor, Tensor], index: int) -> None:
        """Log the loss of a batch."""
        self.log(VALIDATION_LOSS, self._loss(batch), on_epoch=True, batch_size=len(batch[0]), prog_bar=True)

    def configure_optimizers(self) -> OptimizerLRSchedulerConfig:
        """Return Adam with L2 penalty, and a learning rate that falls to zero along half a cosine."""
        settings = self.model.settings
        optimizer = torch.optim.Adam(
            self.network.parameters(), lr=settings.learning_rate, weight_decay=settings.weight_decay
        )
        schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, T_max=self.epochs)
        return {"optimizer": optimizer, "lr_scheduler": {"scheduler": schedule}}

    def _taught(self, batch: tuple[Tensor, Tensor]) -> Tensor:
        """Return the loss of all lessons: what is given has no error in it."""
        return torch.stack([self._loss(batch, forced.to(self.device)) for forced in self.lessons]).sum()

    def _loss(self, batch: tuple[Tensor, Tensor], forced: Tensor | None = None) -> Tensor:
        states, actions = batch
        true = states[:, self.known :]
        teacher = None if forced is None else Teacher(true, forced)
        predicted = self.model.unroll(states[:, : self.known], actions, teacher)
        errors = self.model.layout.errors(predicted, true)
        steps = predicted.shape[1]
        relative = [(errors[name] / usual[:steps]).mean() for name, usual in self.usual.items()]
        return torch.stack(relative).mean()


def lessons(layout: Layout) -> list[Tensor]:
    """Return for each group of quantities that move together the states (states,) of the others, bool.

    Raises:
        InputError: when the layout has no such groups.
    """
    if not layout.moved:
        remedy = "set it to false, or choose train.layout=quadrotor"
        raise InputError(f"{layout.kind!r} has no groups to force", "train.teacher_forcing", remedy)
    quantities = [name.rpartition("_")[0] for name in layout.states]
    return [torch.tensor([name not in group for name in quantities]) for group in layout.moved]


def train_rollouts(
    model: Unrolled, train: Series, validation: Series, training: Training, context: FitContext
) -> float:
    """Train a network further through predictions of `training.steps` steps; return the lowest validation loss.

    Raises:
        InputError: when no segment is long enough, the horizon is to grow for no share of the epochs, or the training
            diverges from the beginning.
    """
    if not 0.0 <= training.growth <= 1.0:
        raise InputError("is a share from 0 to 1 of the epochs", "train.growth", "correct it")
    if context.checkpoint is not None:
        context = replace(context, checkpoint=context.checkpoint / "rollouts")
    module = RolloutRegression(model, train, validation, training, context.seed)
    return train_module(module, model.network, training, context, clip=1.0)


def usual_changes(layout: Layout, series: Series, steps: int) -> dict[str, Tensor]:
    """Return by quantity the mean change from a state to each of the next steps, (steps,)."""
    starts = evenly(_starts(series, steps + 1, "training"), _USUAL_WINDOWS)
    states = gather(series.states, starts, steps + 1)
    changes = layout.errors(states[:, :1].expand(-1, steps, -1), states[:, 1:])
    return {name: change.mean(0).clamp_min(1e-9) for name, change in changes.items()}


def _starts(series: Series, length: int, what: str) -> Tensor:
    starts = series.starts(length)
    if not len(starts):
        raise InputError(
            f"no {what} segment holds {length} samples", "train.steps", "lower it, or record longer"
        )
    return starts


def _single(series: Series) -> Series:
    """Return the series in the precision of the networks."""
    return replace(series, states=series.states.float(), actions=series.actions.float())
