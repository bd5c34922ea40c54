"""Inputs and targets of a learned model of a whole swerve drive, chassis and modules."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.layout import Layout
from simgap.models.swerve_layout import four
from simgap.recordings.recording import Recording

_TWIST = ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")


@dataclass(frozen=True)
class SwerveChassisLayout(Layout):
    """States: chassis velocity and rate in the robot frame, drive and steer velocities, steer angles."""

    kind: ClassVar[str] = "swerve_chassis"
    states: ClassVar[tuple[str, ...]] = (
        *_TWIST,
        *four("drive_velocity"),
        *four("steer_velocity"),
        *four("steer_angle"),
    )

    @property
    def features(self) -> tuple[str, ...]:
        """Velocities m/s and rad/s, cosine and sine of the steer angles, voltages V."""
        stems = ("drive_velocity", "steer_velocity", "steer_cosine", "steer_sine")
        return (*_TWIST, *(name for stem in stems for name in four(stem)), *self.inputs)

    @property
    def targets(self) -> tuple[str, ...]:
        """Increments of all velocities, m/s and rad/s."""
        return self.states[:11]

    @classmethod
    def of_recording(cls, recording: Recording) -> "SwerveChassisLayout":
        """Every swerve recording has the same voltages."""
        return cls((*four("drive_voltage"), *four("steer_voltage")))

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """Angles enter by their cosine and sine, since they wind."""
        angle = state[..., 11:]
        return torch.cat([state[..., :11], torch.cos(angle), torch.sin(angle), action], dim=-1)

    def regressors(self, features: Tensor) -> Tensor:
        """Return the features and the products of each module's cosine and sine with what pushes it.

        That is the chassis velocity, and the module's own drive velocity and voltage, (..., 59 for 27 features): as the
        wheels turn, so do their forces on the chassis, and what of its velocity they feel.
        """
        twist, drive, _, cosine, sine, voltage, _ = features.split((3, 4, 4, 4, 4, 4, 4), dim=-1)
        pushing = torch.cat(
            [twist[..., :1].expand_as(drive), twist[..., 1:2].expand_as(drive), drive, voltage], dim=-1
        )
        turned = [pushing * torch.cat([part] * 4, dim=-1) for part in (cosine, sine)]
        return torch.cat([features, *turned], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the changes of the eleven velocities."""
        return following[..., :11] - state[..., :11]

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Angles move with the mean of the steer velocities at both ends of the step."""
        velocity = state[..., :11] + increment
        angle = state[..., 11:] + 0.5 * time_step * (state[..., 7:11] + velocity[..., 7:])
        return torch.cat([velocity, angle], dim=-1)

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Euclidean norms over the axes or the four modules, m/s, rad/s, and rad for the angles."""
        difference = predicted - true
        sizes = (2, 1, 4, 4, 4)
        names = ("chassis_velocity", "chassis_rate", "drive_velocity", "steer_velocity", "steer_angle")
        parts = zip(names, difference.split(sizes, dim=-1), strict=True)
        return {name: torch.linalg.vector_norm(part, dim=-1) for name, part in parts}
