"""What a learned model of the four steering motors of a swerve drive sees and predicts."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from pipeline.models.layout import Layout
from pipeline.models.swerve_layout import four
from pipeline.recordings.recording import Recording


@dataclass(frozen=True)
class SteeringLayout(Layout):
    """States: steer velocities of the four modules.

    A linear model of two samples is the direct-current motor's law, V against sign(v), v and its difference.
    """

    kind: ClassVar[str] = "steering"
    states: ClassVar[tuple[str, ...]] = four("steer_velocity")

    @property
    def features(self) -> tuple[str, ...]:
        """Velocities rad/s, their signs, voltages V."""
        return (*self.states, *four("steer_sign"), *self.inputs)

    @property
    def targets(self) -> tuple[str, ...]:
        """Increments of the steer velocities, rad/s."""
        return self.states

    @classmethod
    def of_recording(cls, recording: Recording) -> "SteeringLayout":
        """Every swerve recording has the same columns."""
        return cls(four("steer_voltage"))

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """The signs are those of dry friction."""
        return torch.cat([state, torch.sign(state), action], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the changes of the velocities."""
        return following - state

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Return the next velocities."""
        return state + increment

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Euclidean norm over the four modules, rad/s."""
        return {"steer_velocity": torch.linalg.vector_norm(predicted - true, dim=-1)}
