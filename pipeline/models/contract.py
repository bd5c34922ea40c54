"""Interface of learned dynamics models."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import torch
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.bias_correction import BiasCorrection
from simgap.models.examples import Examples, Physics
from simgap.models.layout import Layout
from simgap.models.scaling import Scaler
from simgap.models.settings import ModelSettings, Training
from simgap.models.windows import Series


def _log_nothing(metrics: Mapping[str, float], step: int) -> None:
    """Stand in where no one listens."""


@dataclass(frozen=True)
class FitContext:
    """Context of a fit.

    Attributes:
        seed: of initial weights, order of batches and dropout.
        checkpoint: folder from which a killed fit is taken up again; None where that is not wanted.
        log: called with metrics and their epoch.
    """

    seed: int = 0
    checkpoint: Path | None = None
    log: Callable[[Mapping[str, float], int], None] = _log_nothing


@dataclass(frozen=True)
class Provenance:
    """Provenance of a model.

    Attributes:
        data: SHA-256 of the recording it was fitted on.
        chosen_by: the metric that chose it.
        value: of that metric.
        seed: of every random draw.
        training: the settings of its training.
        data_source: how the recording says it is to be cited.
    """

    data: str = ""
    chosen_by: str = ""
    value: float | None = None
    seed: int = 0
    training: dict[str, Any] = field(default_factory=dict)
    data_source: str = ""


class Teacher(NamedTuple):
    """Teacher forcing: recorded states in the place of predicted ones (Williams & Zipser 1989).

    Attributes:
        states: recorded after each step, (batch, steps, states).
        forced: which of them are given, (states,) bool.
    """

    states: Tensor
    forced: Tensor


Advance = Callable[[Tensor, Any, Tensor], tuple[Tensor, Any]]
"""From states, what is remembered before them, and inputs to the next states and what is remembered then."""


class DynamicsModel(ABC):
    """Predicts the next state of a machine from a window of states and inputs.

    A window holds the last `sequence_length` samples; its last input is held over the predicted step. Over many steps
    a model may remember more than a window: see `begin`, `follow` and `read`.

    Attributes:
        device: on which it predicts; the CPU, unless it was moved.
        layout: what is seen and predicted.
        settings: of the model.
        time_step: s.
        provenance: where the model comes from.
        correction: of the increments that it predicts; None: they are taken as they are.
        residual: whether its increments are what a simulator's physics leave of those of the machine.
        physics: from states and inputs to the next states, where it is a residual that predicts by itself.
        size: what a fit tells of the model's size and that of its data, by name; empty where there is nothing to tell.
    """

    settings_class: ClassVar[type[ModelSettings]]
    kinds: ClassVar[frozenset[str] | None] = None
    """Of the layouts whose machines the model knows; None: of any."""
    fits_residuals: ClassVar[bool] = True
    """Whether it can learn what a simulator leaves; models that are equations of the whole motion cannot."""

    def __init__(self, layout: Layout, settings: ModelSettings, time_step: float) -> None:
        if self.kinds is not None and layout.kind not in self.kinds:
            known = ", ".join(sorted(self.kinds))
            raise InputError(
                f"{settings.name!r} does not support {layout.kind}",
                "model.name",
                f"use another model; it supports {known}",
            )
        self.layout = layout
        self.settings = settings
        self.time_step = time_step
        self.provenance = Provenance()
        self.correction: BiasCorrection | None = None
        self.residual = False
        self.physics: Physics | None = None
        self.size: dict[str, float] = {}
        self.device = torch.device("cpu")

    @abstractmethod
    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Fit to the windows of one series, choose by another, and return the validation loss.

        The loss is the mean squared error of the one-step increments, each scaled by its spread in training; of
        a model trained through open-loop predictions that of the states, see `RolloutRegression`.

        Raises:
            InputError: when a series has no window, or the fit diverges.
        """

    @abstractmethod
    def increments(self, features: Tensor) -> Tensor:
        """Return increments (batch, targets) that follow windows of features (batch, length, features)."""

    @abstractmethod
    def tensors(self) -> dict[str, Tensor]:
        """Return everything that was learned, by name."""

    @abstractmethod
    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over what `tensors` returned.

        Raises:
            InputError: when names or shapes differ from the settings'.
        """

    def to(self, device: torch.device) -> "DynamicsModel":
        """Move all that predictions touch; a residual that a simulator explains stays where its simulator is."""
        if self.physics is None:
            vars(self).update({name: _moved(own, device) for name, own in vars(self).items()})
            self.device = device
        return self

    def examples(self, series: Series, what: str) -> Examples:
        """Return the windows of a series, as long as the settings say; see `Examples.of_series`."""
        return Examples.of_series(series, self.layout, self.settings.sequence_length, what, self.physics)

    def explain_by(self, physics: Physics) -> None:
        """Learn and predict only what the physics leave.

        Raises:
            InputError: when the model is one of the whole motion.
        """
        if not self.fits_residuals:
            found = f"{self.settings.name!r} has equations of the whole motion and cannot learn a residual"
            raise InputError(
                found, "model.name", "choose model=fnn, lstm or tcn, or set simulator.residual=null"
            )
        self.residual, self.physics = True, physics

    def predict(self, states: Tensor, actions: Tensor) -> Tensor:
        """Return the next state of each window.

        Args:
            states: (batch, length, states).
            actions: inputs, (batch, length, inputs).

        Returns:
            (batch, states).
        """
        return self.rollout(states, actions)[:, 0]

    @torch.no_grad()
    def rollout(self, states: Tensor, actions: Tensor) -> Tensor:
        """Return what `unroll` does, without its derivatives; states and inputs need not be on the model's device."""
        return self.unroll(states.to(self.device), actions.to(self.device)).to(states.device)

    def unroll(
        self,
        states: Tensor,
        actions: Tensor,
        teacher: Teacher | None = None,
        advance: Advance | None = None,
    ) -> Tensor:
        """Return the states of many steps, each fed back as the next window's last sample.

        Args:
            states: known to begin with, (batch, length, states).
            actions: inputs, (batch, length − 1 + steps, inputs); the first belong to the known states.
            teacher: says what is fed back in place of what was predicted; None: nothing.
            advance: does what `advance` does; None: that itself.

        Returns:
            (batch, steps, states).
        """
        if self.residual and self.physics is None:
            remedy = "build a simulator with simulator.residual"
            raise InputError("predicts what a simulator leaves, not the motion", "model", remedy)
        length = states.shape[1]
        memory = self.begin(self.layout.encode(states, actions[:, :length]))
        state, action = states[:, -1], actions[:, length - 1]
        state = self.following(state, memory, self.physics and self.physics(state, action))
        reached = [_given(state, teacher, 0)]
        for step in range(1, actions.shape[1] - length + 1):
            # Laid out the same whatever the number of steps, for which it would be compiled anew.
            action = actions[:, length - 1 + step].contiguous()
            state, memory = (advance or self.advance)(reached[-1], memory, action)
            reached.append(_given(state, teacher, step))
        return torch.stack(reached, dim=1)

    def advance(self, state: Tensor, memory: Any, action: Tensor) -> tuple[Tensor, Any]:
        """Return the next states (batch, states), and what is remembered before them, of one more step.

        Args:
            state: (batch, states).
            memory: before this state's sample was seen.
            action: inputs, (batch, inputs).
        """
        memory = self.follow(memory, self.layout.encode(state, action))
        return self.following(state, memory, self.physics and self.physics(state, action)), memory

    def parts(self) -> dict[str, "DynamicsModel"]:
        """Return by name what of the model is scored beside it; most have no such part."""
        return {}

    def identified(self) -> dict[str, dict[str, float]]:
        """Return by target the fitted parameters that have a meaning of their own; most models have none."""
        return {}

    def following(self, state: Tensor, memory: Any, physics: Tensor | None = None) -> Tensor:
        """Return the next states (batch, states) that follow from what is remembered.

        Args:
            state: (batch, states).
            memory: after this state's sample was seen.
            physics: next states by the physics, to which a residual adds; None: the increments are all of the motion.
        """
        layout, increment = self.layout, self._corrected(self.read(memory).to(state.dtype))
        if physics is None:
            return layout.advance(state, increment, self.time_step)
        explained = layout.increment(state, physics)
        with_all, without = (
            layout.advance(state, change, self.time_step) for change in (explained + increment, explained)
        )
        return physics + (with_all - without)

    def begin(self, window: Tensor) -> Any:
        """Return what is remembered of known samples (batch, length, features): the window itself, or a state."""
        return window

    def follow(self, memory: Any, newest: Tensor) -> Any:
        """Return what is remembered once the features (batch, features) of one more sample are seen."""
        return torch.cat([memory[:, 1:], newest[:, None]], dim=1)

    def read(self, memory: Any) -> Tensor:
        """Return the increments (batch, targets) that follow from what is remembered."""
        return self.increments(memory)

    @torch.no_grad()
    def correct(self, series: Series) -> None:
        """Fit a line to true over predicted increments of a series, and correct by it whatever is predicted.

        Raises:
            InputError: when the series has no window.
        """
        examples = self.examples(series, "validation")
        pieces = [
            (self.increments(windows.to(self.device)).to(targets), targets)
            for windows, targets in examples.chunks()
        ]
        predicted, true = (torch.cat(part) for part in zip(*pieces, strict=True))
        self.correction = BiasCorrection.fit(predicted, true)

    def _corrected(self, increments: Tensor) -> Tensor:
        return increments if self.correction is None else self.correction.apply(increments)

    def description(self) -> dict[str, Any]:
        """Return everything about the model but what it learned."""
        return {
            "model": asdict(self.settings),
            "layout": self.layout.as_mapping(),
            "time_step": self.time_step,
            "provenance": asdict(self.provenance),
            "correction": self.correction and self.correction.as_mapping(),
            "residual": self.residual,
        }


def _given(state: Tensor, teacher: Teacher | None, step: int) -> Tensor:
    """Return the predicted states (batch, states), where a teacher gives none."""
    return state if teacher is None else torch.where(teacher.forced, teacher.states[:, step], state)


def _moved(value: Any, device: torch.device) -> Any:
    """Return tensors, networks and models on a device, alone or in a list; anything else as it is."""
    if isinstance(value, list):
        return [_moved(entry, device) for entry in value]
    return value.to(device) if isinstance(value, Tensor | nn.Module | Scaler | DynamicsModel) else value
