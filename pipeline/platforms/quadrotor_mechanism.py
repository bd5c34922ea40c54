"""Nominal mechanism of a quadrotor: rotors with quadratic thrust on a rigid body, without drag."""

from functools import cached_property
from typing import Any

import torch
from torch import Tensor

from simgap.physics import rotations
from simgap.physics.shapes import Channels, PerModule, Real, Signal
from simgap.platforms.mechanism import Channel, Constants, Mechanism, Signals
from simgap.platforms.quadrotor import Quadrotor

_AXES = ("x", "y", "z")
_ALIKE = (1.0, 1.0, 1.0, 1.0)


class QuadrotorMechanism(Mechanism):
    """Newton and Euler in the body frame (FLU).

    Signals: `velocity` body-frame airspeed (..., 3) m/s, `body_rate` (..., 3) rad/s, `attitude` (..., 4),
    `rotor_speed` (..., 4) rad/s or `motor_command` (..., 4) 0..1. Without velocity and attitude there are the torques,
    and with an accelerometer the force along body z, which is thrust less the drag along z.
    Force channels are mass-normalised (what an ideal accelerometer reads), m/s²; torque channels are N·m.
    Source: Mahony, Kumar & Corke 2012, "Multirotor aerial vehicles", eqs. 1–4.
    """

    kind = "quadrotor"
    actuator_signals = ("rotor_speed", "motor_command")
    actuator_output = "rotor_speed"
    actuator_input = "motor_command"
    exerted = ("rotor_speed",)
    channels = (
        *(Channel(f"force_{axis}", "m/s²", "force") for axis in _AXES),
        *(Channel(f"torque_{axis}", "N·m", "torque") for axis in _AXES),
    )

    rotors = tuple(Channel(f"motor_speed_{rotor}", "rad/s", "actuator") for rotor in range(1, 5))

    def __init__(self, platform: Quadrotor) -> None:
        self.platform = platform

    def channels_of(self, signals: Signals) -> tuple[Channel, ...]:
        """Return those of the body, and one per rotor where both its command and its speed are recorded."""
        both = self.actuator_output in signals and self.actuator_input in signals
        body = tuple(channel for channel in self.channels if _is_tested(channel, signals))
        return (*body, *self.rotors) if both else body

    def readings(self, signals: Signals, constants: Constants) -> dict[str, tuple[Real, Real]]:
        """Return the recorded rotor speeds beside those that the command makes, rad/s."""
        commanded = signals.get(f"commanded_{self.actuator_output}")
        if commanded is None:
            return {}
        measured = signals[self.actuator_output]
        return {
            channel.name: (measured[..., place], commanded[..., place])
            for place, channel in enumerate(self.rotors)
        }

    def constants(self) -> dict[str, Any]:
        """Return mass, coefficients, inertia and geometry of the platform."""
        return dict(self._constants)

    @cached_property
    def _constants(self) -> dict[str, Any]:
        platform = self.platform
        return {
            "mass": platform.mass,
            "gravity": platform.gravity,
            "thrust_coefficient": platform.thrust_coefficient,
            "torque_coefficient": platform.torque_coefficient,
            "motor_speed_max": platform.motor_speed_max,
            "nominal_voltage": platform.nominal_voltage,
            "inertia": torch.tensor(platform.inertia, dtype=torch.float64),
            "rotor_positions": torch.tensor(platform.rotor_positions, dtype=torch.float64),
            "rotor_directions": torch.tensor(platform.rotor_directions, dtype=torch.float64),
            "thrust_ratios": torch.tensor(platform.thrust_ratios or _ALIKE, dtype=torch.float64),
            "torque_ratios": torch.tensor(platform.torque_ratios or _ALIKE, dtype=torch.float64),
        }

    def actuate(self, signals: Signals, constants: Constants) -> dict[str, Signal]:
        """Rotor speed follows the command at once and in proportion, unless it is given."""
        if "rotor_speed" in signals:
            return dict(signals)
        return {**signals, "rotor_speed": constants["motor_speed_max"] * signals["motor_command"]}

    def wrench(self, signals: Signals, constants: Constants) -> Channels:
        """Thrust along body z; torques by lever arms and reaction."""
        thrust = rotor_thrust(signals, constants)
        positions = constants["rotor_positions"].to(thrust)
        zero = torch.zeros_like(thrust[..., 0])
        return {
            "force_x": zero,
            "force_y": zero,
            "force_z": thrust.sum(-1) / constants["mass"],
            "torque_x": (positions[:, 1] * thrust).sum(-1),
            "torque_y": -(positions[:, 0] * thrust).sum(-1),
            "torque_z": rotor_reaction(signals, constants).sum(-1),
        }

    def inertial(self, signals: Signals, constants: Constants) -> Channels:
        """Gravity and the transport terms ω × u of the body frame, and the gyroscopic torque ω × Jω."""
        rate = signals["body_rate"]
        torque = _named("torque", -rotations.cross(rate, constants["inertia"].to(rate) * rate))
        if "velocity" not in signals:
            return torque
        velocity = signals["velocity"]
        down = torch.zeros_like(velocity)
        down[..., 2] = -constants["gravity"]
        force = rotations.rotate_inverse(signals["attitude"], down) - rotations.cross(rate, velocity)
        return _named("force", force) | torque

    def momentum(self, signals: Signals, constants: Constants) -> Channels:
        """Body-frame velocity (mass-normalised momentum), where it is known, and angular momentum."""
        angular = _named("torque", constants["inertia"].to(signals["body_rate"]) * signals["body_rate"])
        return _named("force", signals["velocity"]) | angular if "velocity" in signals else angular

    def inertia(self, constants: Constants) -> dict[str, float]:
        """One for the mass-normalised forces, the principal moments for the torques."""
        moments = constants["inertia"].tolist()
        return {f"force_{axis}": 1.0 for axis in _AXES} | {
            f"torque_{axis}": moment for axis, moment in zip(_AXES, moments, strict=True)
        }


def _is_tested(channel: Channel, signals: Signals) -> bool:
    """Whether signals can test an equation: a force needs the velocity; the one along z is thrust, which is sensed."""
    sensed = channel.name == "force_z" and "specific_force" in signals
    return channel.group == "torque" or "velocity" in signals or sensed


def rotor_thrust(signals: Signals, constants: Constants) -> PerModule:
    """Return the thrust of each rotor along body z in still air, (..., 4) N."""
    squared = signals["rotor_speed"].square()
    return constants["thrust_coefficient"] * constants["thrust_ratios"].to(squared) * squared


def rotor_reaction(signals: Signals, constants: Constants) -> PerModule:
    """Return the torque of each rotor's air drag on the body about +z, (..., 4) N·m."""
    squared = signals["rotor_speed"].square()
    turning = constants["rotor_directions"].to(squared) * constants["torque_ratios"].to(squared)
    return constants["torque_coefficient"] * turning * squared


def _named(stem: str, vector: Tensor) -> dict[str, Tensor]:
    return {f"{stem}_{axis}": vector[..., index] for index, axis in enumerate(_AXES)}
