"""Inputs and targets of a learned model of a joint."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.layout import Layout
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class JointLayout(Layout):
    """States: position (rad or m) and velocity.

    Attributes:
        sliding: whether the position is in metres.
    """

    kind: ClassVar[str] = "joint"
    states: ClassVar[tuple[str, ...]] = ("position", "velocity")
    sliding: bool = False

    @property
    def features(self) -> tuple[str, ...]:
        """Position m, or its sine and cosine; velocity; voltage V or effort."""
        position = ("position",) if self.sliding else ("position_sine", "position_cosine")
        return (*position, "velocity", *self.inputs)

    @property
    def targets(self) -> tuple[str, ...]:
        """The increment of the velocity."""
        return ("velocity",)

    @classmethod
    def of_recording(cls, recording: Recording) -> "JointLayout":
        """Take the voltage where it was recorded, else the effort."""
        name = "voltage" if "voltage" in recording.units else "effort"
        return cls((name,), sliding=recording.units.get("position") == "m")

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """A turning joint may wind, so its position enters by sine and cosine."""
        position = state[..., :1]
        seen = [position] if self.sliding else [torch.sin(position), torch.cos(position)]
        return torch.cat([*seen, state[..., 1:], action], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the change of the velocity."""
        return following[..., 1:] - state[..., 1:]

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """The position moves with the mean of the velocities at both ends of the step."""
        position, velocity = state[..., :1], state[..., 1:]
        following = velocity + increment
        return torch.cat([position + 0.5 * time_step * (velocity + following), following], dim=-1)

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Absolute differences, in rad or m and per second."""
        difference = (predicted - true).abs()
        return {"position": difference[..., 0], "velocity": difference[..., 1]}
