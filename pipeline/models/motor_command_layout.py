"""Inputs and targets of a learned model of a quadrotor's motor commands (inverse dynamics)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.layout import Layout
from simgap.physics import rotations
from simgap.platforms import Quadrotor, platform_from_config
from simgap.recordings.recording import Recording

REACTION = 0.02  # s after which the motion that a command causes is seen, about a rotor's time constant
_MOTION_COLUMNS = tuple(
    f"{stem}_{axis}"
    for stem, axes in (("attitude", "wxyz"), ("velocity", "xyz"), ("body_rate", "xyz"))
    for axis in axes
)
_SETPOINTS = ("thrust_command", *(f"body_rate_command_{axis}" for axis in "xyz"))
_REQUESTS = (*(f"specific_force_{axis}" for axis in "xyz"), "battery_voltage")


@dataclass(frozen=True)
class MotorCommandLayout(Layout):
    """State: the motor commands. Inputs: the motion at their sample and up to `REACTION` after it.

    Without recorded stick inputs and setpoints, the achieved motion stands for the commanded one.

    Attributes:
        rotor_x: forward places of the rotors in the body frame, m.
        rotor_y: left.
        rotor_z: up.
    """

    kind: ClassVar[str] = "motor_command"
    states: ClassVar[tuple[str, ...]] = tuple(f"motor_command_{number}" for number in range(1, 5))
    rotor_x: tuple[float, ...] = ()
    rotor_y: tuple[float, ...] = ()
    rotor_z: tuple[float, ...] = ()

    @property
    def features(self) -> tuple[str, ...]:
        """Velocity of every rotor m/s and body rate rad/s, body frame; specific force m/s², voltage V."""
        rotors = (f"rotor_{number}_velocity_{axis}" for number in range(1, 5) for axis in "xyz")
        rates = (f"body_rate_{axis}" for axis in "xyz")
        return (*rotors, *rates, *self.inputs[len(_MOTION_COLUMNS) :])

    @property
    def input_features(self) -> int:
        """All: the commands are not seen."""
        return len(self.features)

    @property
    def targets(self) -> tuple[str, ...]:
        """The motor commands, 0 to 1."""
        return self.states

    @classmethod
    def of_recording(cls, recording: Recording) -> "MotorCommandLayout":
        """Take the motion, and specific force and voltage where they were recorded."""
        requests = tuple(name for name in _REQUESTS if name in recording.units)
        lead = 1 + round(REACTION / recording.time_step)
        return cls((*_MOTION_COLUMNS, *requests), lead=lead)

    def on(self, platform: Mapping[str, Any]) -> "MotorCommandLayout":
        """Take the places of the rotors.

        Raises:
            InputError: when the platform is no quadrotor.
        """
        machine = platform_from_config(platform)
        if not isinstance(machine, Quadrotor):
            raise InputError(
                f"is a {machine.kind}, not a quadrotor", "platform", "choose another train.layout"
            )
        x, y, z = zip(*machine.rotor_positions, strict=True)
        return replace(self, rotor_x=x, rotor_y=y, rotor_z=z)

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """The velocity of each rotor is the body's and what its turning adds; the commands are not seen."""
        attitude, velocity, rate = action[..., :4], action[..., 4:7], action[..., 7:10]
        body = rotations.rotate_inverse(attitude, velocity)
        places = torch.tensor([self.rotor_x, self.rotor_y, self.rotor_z], dtype=action.dtype).T
        turning = torch.linalg.cross(
            rate[..., None, :], places.to(action.device).expand(*rate.shape[:-1], 4, 3)
        )
        rotors = (body[..., None, :] + turning).flatten(-2)
        return torch.cat([rotors, rate, action[..., 10:]], dim=-1)

    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the commands themselves: they are not built up step by step."""
        return following

    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Return the predicted commands."""
        return increment

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Absolute differences by motor, 0 to 1."""
        difference = (predicted - true).abs()
        return {name: difference[..., index] for index, name in enumerate(self.states)}


@dataclass(frozen=True)
class MotorSetpointLayout(MotorCommandLayout):
    """State: the motor commands. Inputs: motion and setpoints at the same instant, as Kantue & Pedro have them.

    Their four stick inputs are the setpoints of thrust and body rates, as far as they were recorded.
    """

    kind: ClassVar[str] = "motor_setpoint"

    @property
    def features(self) -> tuple[str, ...]:
        """Body velocity u, v, w m/s; body rate p, q, r rad/s; setpoints of thrust m/s² and body rates rad/s."""
        moving = (f"{stem}_{axis}" for stem in ("body_velocity", "body_rate") for axis in "xyz")
        return (*moving, *self.inputs[len(_MOTION_COLUMNS) :])

    @classmethod
    def of_recording(cls, recording: Recording) -> "MotorSetpointLayout":
        """Take the motion, and the setpoints that were recorded; a command is predicted from its own instant."""
        setpoints = tuple(name for name in _SETPOINTS if name in recording.units)
        return cls((*_MOTION_COLUMNS, *setpoints), lead=1)

    def on(self, platform: Mapping[str, Any]) -> "MotorSetpointLayout":
        """Return the layout: it does not know where the rotors are."""
        return self

    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """Velocities along the body's axes; the commands are not seen."""
        body = rotations.rotate_inverse(action[..., :4], action[..., 4:7])
        return torch.cat([body, action[..., 7:]], dim=-1)
