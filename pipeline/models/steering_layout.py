"""Inputs and targets of a learned model of a swerve drive's steering motor."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.rate_layout import RateLayout
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class SteeringLayout(RateLayout):
    """State: steer velocity of a module. The four modules are machines of one kind, each seen by itself.

    A linear model of two samples is the direct-current motor's law, V against sign(v), v and its difference.
    """

    kind: ClassVar[str] = "steering"
    states: ClassVar[tuple[str, ...]] = ("steer_velocity",)

    @property
    def features(self) -> tuple[str, ...]:
        """Velocity rad/s, its sign, voltage V."""
        return ("steer_velocity", "steer_sign", *self.inputs)

    def machines(self) -> dict[str, tuple[str, ...]]:
        """Return the columns of each module."""
        return {
            f"_{number}": tuple(f"{name}_{number}" for name in (*self.states, *self.inputs))
            for number in range(1, 5)
        }

    @classmethod
    def of_recording(cls, recording: Recording) -> "SteeringLayout":
        """Every swerve recording has the same columns."""
        return cls(("steer_voltage",))

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """The sign is that of dry friction."""
        return torch.cat([state, torch.sign(state), action], dim=-1)

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Absolute difference, rad/s."""
        return {"steer_velocity": (predicted - true).abs()[..., 0]}
