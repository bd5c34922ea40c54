"""Inputs and targets of a learned model of a quadrotor's attitude control."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.layout import Layout
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class AttitudeLayout(Layout):
    """From commanded to true body rates, axis by axis: the quantity that a pilot's stick commands.

    Angles are left out: they follow from the rates by kinematics, which needs no learning.
    """

    kind: ClassVar[str] = "attitude"
    states: ClassVar[tuple[str, ...]] = tuple(f"body_rate_{axis}" for axis in "xyz")

    @property
    def features(self) -> tuple[str, ...]:
        """Body rates and commanded body rates, rad/s."""
        return (*self.states, *self.inputs)

    @property
    def targets(self) -> tuple[str, ...]:
        """Increments of the body rates, rad/s."""
        return self.states

    @classmethod
    def of_recording(cls, recording: Recording) -> "AttitudeLayout":
        """Every recording with commanded body rates has the same columns."""
        return cls(tuple(f"body_rate_command_{axis}" for axis in "xyz"))

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """Rates and commands side by side."""
        return torch.cat([state, action], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the changes of the body rates."""
        return following - state

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Add the increments."""
        return state + increment

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Absolute differences by axis, rad/s."""
        difference = (predicted - true).abs()
        return {
            name: difference[..., index] for index, name in enumerate(("roll_rate", "pitch_rate", "yaw_rate"))
        }
