"""Inputs and targets of a learned model of a quadrotor."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.layout import Layout
from simgap.physics import rotations
from simgap.recordings.contract import QUADROTOR_STATE
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class QuadrotorLayout(Layout):
    """States in the order of the contract: position, attitude, velocity (world), body rate."""

    kind: ClassVar[str] = "quadrotor"
    states: ClassVar[tuple[str, ...]] = tuple(QUADROTOR_STATE)
    moved: ClassVar[tuple[tuple[str, ...], ...]] = (("position", "velocity"), ("attitude", "body_rate"))

    @property
    def features(self) -> tuple[str, ...]:
        """Body velocity m/s, gravity's direction, body rate rad/s, squared motor speeds or commands."""
        stems = ("body_velocity", "gravity", "body_rate")
        squared = (f"{name}_squared" for name in self.inputs)
        return (*(f"{stem}_{axis}" for stem in stems for axis in "xyz"), *squared)

    @property
    def targets(self) -> tuple[str, ...]:
        """Increments of velocity, in the body frame of the step's beginning, m/s, and of body rate, rad/s."""
        return tuple(f"{stem}_{axis}" for stem in ("velocity", "body_rate") for axis in "xyz")

    @classmethod
    def of_recording(cls, recording: Recording) -> "QuadrotorLayout":
        """Take motor speeds where they were recorded, else commands."""
        stem = "motor_speed" if "motor_speed_1" in recording.units else "motor_command"
        return cls(tuple(f"{stem}_{number}" for number in range(1, 5)))

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """Thrust and drag depend on the body frame only: position and heading are left out."""
        _, attitude, velocity, rate = _parts(state)
        down = torch.zeros_like(velocity)
        down[..., 2].fill_(-1.0)
        body_velocity = rotations.rotate_inverse(attitude, velocity)
        return torch.cat([body_velocity, rotations.rotate_inverse(attitude, down), rate, action**2], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the mean acceleration times the step, in the body frame, and the change of body rate."""
        _, attitude, velocity, rate = _parts(state)
        _, _, next_velocity, next_rate = _parts(following)
        change = rotations.rotate_inverse(attitude, next_velocity - velocity)
        return torch.cat([change, next_rate - rate], dim=-1)

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Position and attitude move with the mean velocity, and mean rate, of both ends of the step."""
        position, attitude, velocity, rate = _parts(state)
        next_velocity = velocity + rotations.rotate(attitude, increment[..., :3])
        next_rate = rate + increment[..., 3:]
        turn = rotations.from_rotation_vector(0.5 * time_step * (rate + next_rate))
        next_attitude = rotations.normalize(rotations.multiply(attitude, turn))
        next_position = position + 0.5 * time_step * (velocity + next_velocity)
        return torch.cat([next_position, next_attitude, next_velocity, next_rate], dim=-1)

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Euclidean norms in m, m/s and rad/s; for the attitude the angle of the rotation between, rad."""
        names = ("position", "attitude", "velocity", "body_rate")
        sizes = {
            name: torch.linalg.vector_norm(one - other, dim=-1)
            for name, one, other in zip(names, _parts(predicted), _parts(true), strict=True)
        }
        return sizes | {"attitude": rotations.rotation_angle(_parts(predicted)[1], _parts(true)[1])}


def _parts(state: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    return state[..., :3], state[..., 3:7], state[..., 7:10], state[..., 10:13]
