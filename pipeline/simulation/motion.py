"""State space of each platform kind: its state tensor, its signals, and its rate of change."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.physics import rigid_body, rotations
from simgap.physics.shapes import Real, Signal, Signals, State
from simgap.platforms import Platform, Swerve
from simgap.platforms.swerve_kinematics import rolling_speed
from simgap.platforms.swerve_mechanism import SwerveMechanism, wheel_angle


class Motion(ABC):
    """The state of one platform kind.

    `parts` names the slices of the state tensor (..., n); the same names, with recorded signals, make a state.
    `velocities` names the parts that forces change directly; the others follow by integration.
    """

    parts: ClassVar[dict[str, slice]]
    velocities: ClassVar[tuple[str, ...]]

    @abstractmethod
    def pack(self, signals: Signals) -> State:
        """Return the state tensor (..., n) that these signals describe."""

    @abstractmethod
    def signals(self, state: State, constants: Mapping[str, Any] | None = None) -> dict[str, Signal]:
        """Return the signals that effects and mechanism read from a state; without constants, the platform's own."""

    @abstractmethod
    def derivative(self, state: State, wrench: Mapping[str, Real], constants: Mapping[str, Any]) -> State:
        """Return the rate of change of the state under a wrench."""

    def normalise(self, state: State) -> State:
        """Return the state with what integration let drift put right."""
        return state


class QuadrotorMotion(Motion):
    """Position (world), attitude, velocity (world), body rate."""

    parts: ClassVar = {
        "position": slice(0, 3),
        "attitude": slice(3, 7),
        "velocity": slice(7, 10),
        "body_rate": slice(10, 13),
    }
    velocities = ("velocity", "body_rate")

    def pack(self, signals: Signals) -> Float[Tensor, "*batch 13"]:
        """Return (..., 13); the velocity among the signals is in the body frame."""
        velocity = rotations.rotate(signals["attitude"], signals["velocity"])
        return torch.cat([signals["position"], signals["attitude"], velocity, signals["body_rate"]], dim=-1)

    def signals(
        self, state: Float[Tensor, "*batch 13"], constants: Mapping[str, Any] | None = None
    ) -> dict[str, Signal]:
        """Return the parts, with velocity in the body frame."""
        parts = {name: state[..., where] for name, where in self.parts.items()}
        return parts | {"velocity": rotations.rotate_inverse(parts["attitude"], parts["velocity"])}

    def derivative(
        self, state: Float[Tensor, "*batch 13"], wrench: Mapping[str, Real], constants: Mapping[str, Any]
    ) -> Float[Tensor, "*batch 13"]:
        """Newton and Euler; specific force and torque in the body frame."""
        attitude, velocity, rate = (state[..., self.parts[n]] for n in ("attitude", "velocity", "body_rate"))
        force = torch.stack([wrench[f"force_{axis}"] for axis in "xyz"], dim=-1)
        torque = torch.stack([wrench[f"torque_{axis}"] for axis in "xyz"], dim=-1)
        inertia = constants["inertia"].to(state)
        return torch.cat(
            [
                velocity,
                rotations.quaternion_derivative(attitude, rate),
                rigid_body.linear_acceleration(attitude, force, constants["gravity"]),
                rigid_body.angular_acceleration(rate, torque, inertia),
            ],
            dim=-1,
        )

    def normalise(self, state: Float[Tensor, "*batch 13"]) -> Float[Tensor, "*batch 13"]:
        """Return the state with a unit quaternion."""
        attitude = rotations.normalize(state[..., self.parts["attitude"]])
        return torch.cat([state[..., :3], attitude, state[..., 7:]], dim=-1)


class RotationMotion(Motion):
    """Body rate of a quadrotor alone, where neither position, velocity nor attitude is known."""

    parts: ClassVar = {"body_rate": slice(0, 3)}
    velocities = ("body_rate",)

    def pack(self, signals: Signals) -> Float[Tensor, "*batch 3"]:
        """Return (..., 3)."""
        return signals["body_rate"]

    def signals(
        self, state: Float[Tensor, "*batch 3"], constants: Mapping[str, Any] | None = None
    ) -> dict[str, Signal]:
        """Return the body rate."""
        return {"body_rate": state}

    def derivative(
        self, state: Float[Tensor, "*batch 3"], wrench: Mapping[str, Real], constants: Mapping[str, Any]
    ) -> Float[Tensor, "*batch 3"]:
        """Euler's equations; torque in the body frame."""
        torque = torch.stack([wrench[f"torque_{axis}"] for axis in "xyz"], dim=-1)
        return rigid_body.angular_acceleration(state, torque, constants["inertia"].to(state))


class JointMotion(Motion):
    """Position and velocity of the axis."""

    parts: ClassVar = {"position": slice(0, 1), "velocity": slice(1, 2)}
    velocities = ("velocity",)

    def pack(self, signals: Signals) -> Float[Tensor, "*batch 2"]:
        """Return (..., 2)."""
        return torch.stack([signals["position"], signals["velocity"]], dim=-1)

    def signals(
        self, state: Float[Tensor, "*batch 2"], constants: Mapping[str, Any] | None = None
    ) -> dict[str, Signal]:
        """Return position and velocity."""
        return {"position": state[..., 0], "velocity": state[..., 1]}

    def derivative(
        self, state: Float[Tensor, "*batch 2"], wrench: Mapping[str, Real], constants: Mapping[str, Any]
    ) -> Float[Tensor, "*batch 2"]:
        """Velocity, and wrench over inertia."""
        acceleration = wrench[constants["channel"]] / constants["inertia"]
        return torch.stack([state[..., 1], acceleration], dim=-1)


class SwerveMotion(Motion):
    """Chassis velocity (robot frame, with yaw rate), steering angles and steering rates, heading since the start."""

    parts: ClassVar = {
        "chassis_velocity": slice(0, 3),
        "steer_angle": slice(3, 7),
        "steer_velocity": slice(7, 11),
        "heading": slice(11, 12),
    }
    velocities = ("chassis_velocity", "steer_velocity")

    def __init__(self, platform: Swerve) -> None:
        self.mechanism = SwerveMechanism(platform)

    def pack(self, signals: Signals) -> Float[Tensor, "*batch 12"]:
        """Return (..., 12); the heading is zero where none is given."""
        angle = signals["steer_angle"]
        heading = signals.get("heading", torch.zeros_like(angle[..., 0]))
        return torch.cat(
            [signals["chassis_velocity"], angle, signals["steer_velocity"], heading[..., None]], dim=-1
        )

    def signals(
        self, state: Float[Tensor, "*batch 12"], constants: Mapping[str, Any] | None = None
    ) -> dict[str, Signal]:
        """Return the parts and the drive motors' speeds, which follow from rolling without slip."""
        parts = {name: state[..., where] for name, where in self.parts.items()}
        parts["heading"] = parts["heading"][..., 0]
        return parts | {"drive_velocity": _motor_speed(parts, constants or self.mechanism.constants())}

    def derivative(
        self, state: Float[Tensor, "*batch 12"], wrench: Mapping[str, Real], constants: Mapping[str, Any]
    ) -> Float[Tensor, "*batch 12"]:
        """Chassis and modules as rigid bodies, seen from the turning robot frame; wheels do not slide sideways."""
        parts = {name: state[..., where] for name, where in self.parts.items()}
        parts |= self.mechanism.derived(parts, constants)
        inertial = self.mechanism.inertial(parts, constants)
        acting = self.mechanism.constrain(wrench, parts, constants)
        masses = {"x": constants["mass"], "y": constants["mass"], "yaw": constants["inertia"]}
        chassis = [
            (acting[f"drive_{axis}"] + inertial[f"drive_{axis}"]) / mass for axis, mass in masses.items()
        ]
        steer = torch.stack([acting[f"steer_{module}"] for module in range(1, 5)], dim=-1)
        faster = torch.stack(chassis, dim=-1), parts["steer_velocity"], steer / constants["steer_inertia"]
        return torch.cat([*faster, parts["chassis_velocity"][..., 2:]], dim=-1)


def _motor_speed(parts: Signals, constants: Mapping[str, Any]) -> Tensor:
    angle = wheel_angle(parts["steer_angle"], constants)
    rolling = rolling_speed(parts["chassis_velocity"], angle, constants["module_positions"])
    driven = rolling * (constants["drive_gear_ratio"] / constants["wheel_radius"])
    return driven + constants["coupling_ratio"] * parts["steer_velocity"]


def motion_of(platform: Platform, known: Signals | None = None) -> Motion:
    """Return the motion that belongs to a platform.

    Args:
        platform: of any kind.
        known: recorded signals; without the attitude among them only a quadrotor's rotation can be followed. None where
            all is known.
    """
    if isinstance(platform, Swerve):
        return SwerveMotion(platform)
    if platform.kind != "quadrotor":
        return JointMotion()
    return QuadrotorMotion() if known is None or "attitude" in known else RotationMotion()


def motion_of_state(platform: Platform, state: State) -> Motion:
    """Return the motion of a platform whose state this is, (..., n)."""
    only_rotation = platform.kind == "quadrotor" and state.shape[-1] == 3
    return motion_of(platform, {} if only_rotation else None)
