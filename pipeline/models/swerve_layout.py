"""Inputs and targets of a learned model of a swerve drive's modules."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.layout import Layout
from simgap.recordings.recording import Recording

_GROUPS = ("drive_velocity", "steer_velocity", "steer_angle")


def four(stem: str) -> tuple[str, ...]:
    """Return the names of a quantity of all modules."""
    return tuple(f"{stem}_{number}" for number in range(1, 5))


@dataclass(frozen=True)
class SwerveLayout(Layout):
    """States: drive velocities (motor), steer velocities and steer angles (module) of the four modules."""

    kind: ClassVar[str] = "swerve"
    states: ClassVar[tuple[str, ...]] = tuple(name for stem in _GROUPS for name in four(stem))

    @property
    def features(self) -> tuple[str, ...]:
        """Velocities rad/s, cosine and sine of the steer angles, voltages V."""
        stems = ("drive_velocity", "steer_velocity", "steer_cosine", "steer_sine")
        return (*(name for stem in stems for name in four(stem)), *self.inputs)

    @property
    def targets(self) -> tuple[str, ...]:
        """Increments of drive and steer velocities, rad/s."""
        return (*four("drive_velocity"), *four("steer_velocity"))

    @classmethod
    def of_recording(cls, recording: Recording) -> "SwerveLayout":
        """Every swerve recording has the same columns."""
        return cls((*four("drive_voltage"), *four("steer_voltage")))

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """Angles enter by their cosine and sine, since they wind."""
        angle = state[..., 8:]
        return torch.cat([state[..., :8], torch.cos(angle), torch.sin(angle), action], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the changes of the eight velocities."""
        return following[..., :8] - state[..., :8]

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Angles move with the mean of the steer velocities at both ends of the step."""
        velocity = state[..., :8] + increment
        angle = state[..., 8:] + 0.5 * time_step * (state[..., 4:8] + velocity[..., 4:])
        return torch.cat([velocity, angle], dim=-1)

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Euclidean norms over the four modules, rad/s, and rad for the angles."""
        difference = predicted - true
        parts = {name: difference[..., 4 * i : 4 * i + 4] for i, name in enumerate(_GROUPS)}
        return {name: torch.linalg.vector_norm(part, dim=-1) for name, part in parts.items()}
