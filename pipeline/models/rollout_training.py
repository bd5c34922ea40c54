"""Training through open-loop predictions, which penalises errors that grow from step to step.

Source: Mohajerin, Mozifian & Waslander 2018, "Deep learning a quadrotor dynamic model for multi-step prediction".
"""

import math
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

import torch
from pytorch_lightning.utilities.types import OptimizerLRSchedulerConfig
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.accelerator import accelerator
from simgap.models.contract import Advance, FitContext, Teacher
from simgap.models.descent import Descent
from simgap.models.layout import Layout
from simgap.models.settings import TrainedSettings, Training
from simgap.models.training import train_module
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

    @property
    def device(self) -> torch.device:
        """On which it predicts."""

    def to(self, device: torch.device) -> object:
        """Move all that its predictions touch."""

    def advance(self, state: Tensor, memory: Any, action: Tensor) -> tuple[Tensor, Any]:
        """Return what `DynamicsModel.advance` does."""

    def unroll(
        self, states: Tensor, actions: Tensor, teacher: Teacher | None = None, advance: Advance | None = None
    ) -> Tensor:
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


class RolloutRegression(Descent):
    """Mean error of open-loop predictions, each quantity and step over its usual change until then.

    The error is not squared, because a few diverging windows would dominate a squared error.

    With teacher forcing there is a prediction for each group of quantities, to which the others are given. Validation
    gives none.

    Dropout and batch normalisation run as in prediction, because the outputs are fed back.
    """

    def __init__(
        self, model: Unrolled, train: Series, validation: Series, training: Training, seed: int
    ) -> None:
        super().__init__(model.network, model.settings, clip=1.0)
        self.model = model
        self.train_series, self.validation_series = _single(train), _single(validation)
        self.steps, self.size, self.seed = training.steps, training.batch_size, seed
        self.epochs, self.growing = training.max_epochs, round(training.growth * training.max_epochs)
        self.known = model.settings.sequence_length
        self.lessons = lessons(model.layout) if training.teacher_forcing else []
        self.usual = usual_changes(model.layout, self.train_series, training.steps)
        self.predicted = 0  # steps in the epoch before
        self.advance: Advance | None = None

    def train_dataloader(self) -> Stretches:
        """Shuffle anew by seed and epoch, so that a resumed epoch is the one that was interrupted."""
        length = self.known + self.horizon()
        starts = _starts(self.train_series, length, "training")
        generator = torch.Generator().manual_seed((self.seed * 100_003 + self.current_epoch) % 2**63)
        order = torch.randperm(len(starts), generator=generator)
        kept = max(len(order) // _THINNING, self.size)
        if self.device.type == "cuda":
            kept -= kept % self.size  # what is compiled is so for one size of batch
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
        """Keep the network as it is in prediction, and no graph of a shorter horizon."""
        self.network.eval()
        if self.predicted != (steps := self.horizon()):
            self.forget()
            self.predicted = steps

    def on_train_batch_end(self, *_: Any) -> None:
        """Let the learning rate fall at the end of an epoch."""
        if self.trainer.is_last_batch:
            self.schedule.step()

    def configure_optimizers(self) -> OptimizerLRSchedulerConfig:
        """Return Adam with L2 penalty, and a learning rate that falls to zero along half a cosine."""
        optimizer = super().configure_optimizers()
        self.schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, T_max=self.epochs)
        return {"optimizer": optimizer, "lr_scheduler": {"scheduler": self.schedule}}

    def place(self) -> None:
        """Move the samples and what errors are measured by; the model is there. Compile a step of it."""
        if self.device.type == "cuda":
            self.advance = _compiled(self.model.advance)
        self.train_series, self.validation_series = (
            series.to(self.device) for series in (self.train_series, self.validation_series)
        )
        self.lessons = [forced.to(self.device) for forced in self.lessons]
        self.usual = {name: usual.to(self.device) for name, usual in self.usual.items()}

    def taught(self, *batch: Tensor) -> Tensor:
        """Return the loss of all lessons, where there are some: what is given has no error in it."""
        states, actions = batch
        if not self.lessons:
            return self._loss(states, actions, None, self.advance)
        return torch.stack(
            [self._loss(states, actions, forced, self.advance) for forced in self.lessons]
        ).sum()

    def loss(self, *batch: Tensor) -> Tensor:
        """Return the loss of states and inputs."""
        states, actions = batch
        return self._loss(states, actions)

    def _loss(
        self,
        states: Tensor,
        actions: Tensor,
        forced: Tensor | None = None,
        advance: Advance | None = None,
    ) -> Tensor:
        true = states[:, self.known :]
        teacher = None if forced is None else Teacher(true, forced)
        # The library of NVIDIA has no derivatives of recurrent layers that run as in prediction.
        with torch.backends.cudnn.flags(enabled=False):
            predicted = self.model.unroll(states[:, : self.known], actions, teacher, advance)
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
    model.to(accelerator())
    loss = train_module(module, model.network, training, context, model.device)
    model.to(torch.device("cpu"))
    return loss


def _compiled(advance: Advance) -> Advance:
    """Return a step as fewer and larger kernels, which takes a minute; the step itself where nothing compiles."""
    if shutil.which(os.environ.get("CC", "cc")) is None:
        return advance
    torch._dynamo.reset()  # so many compiled steps of earlier models are kept, and no more
    return torch.compile(advance, dynamic=False)


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
