"""One machine of each kind, and states and inputs that such a machine may have."""

import torch
from torch import Tensor

from simgap.effects import Effect, effects_of
from simgap.physics import rotations
from simgap.platforms import (
    Controller,
    DirectCurrentMotor,
    Joint,
    JointMotor,
    Platform,
    Quadrotor,
    SteerAxis,
    Swerve,
    SwerveAxis,
)

_NEO = DirectCurrentMotor(nominal_voltage=12.0, free_speed=594.4, stall_torque=2.6, stall_current=105.0)

QUADROTOR = Quadrotor(
    mass=0.87,
    inertia=(2.89e-3, 2.43e-3, 4.97e-3),
    rotor_positions=((0.075, -0.1, 0.01), (-0.075, -0.1, 0.01), (-0.075, 0.1, 0.01), (0.075, 0.1, 0.01)),
    rotor_directions=(-1, 1, -1, 1),
    thrust_coefficient=1.5625e-6,
    torque_coefficient=3.4375e-8,
    motor_speed_max=2366.4,
    nominal_voltage=14.8,
)
SWERVE = Swerve(
    mass=54.0,
    inertia=6.0,
    module_positions=((0.3, 0.25), (-0.3, 0.25), (-0.3, -0.25), (0.3, -0.25)),
    wheel_radius=0.0508,
    drive=SwerveAxis(6.75, _NEO),
    steer=SteerAxis(21.4, _NEO, 0.05),
)
JOINT = Joint(
    inertia=0.02,
    gravity_torque=0.4,
    stiffness=0.3,
    motor=JointMotor(resistance=2.0, torque_constant=0.03, gear_ratio=20.0),
)
MACHINES: dict[str, Platform] = {"quadrotor": QUADROTOR, "swerve": SWERVE, "joint": JOINT}

SERVO = Joint(
    inertia=0.02, gravity_torque=0.4, stiffness=0.3, controller=Controller(9.0, 0.5, effort_limit=4.0)
)

EVERY_EFFECT = [
    effect for kind in MACHINES for effect in effects_of(kind) if "position_command" not in effect.needs
]
"""All but those of a servo that is told a position, for which see test_servo.py."""


def identity(effect: Effect) -> str:
    """Name an effect in the report of a parametrised test."""
    return f"{effect.kind}-{effect.key}"


def some_signals(
    kind: str, shape: tuple[int, ...], seed: int, dtype: torch.dtype = torch.float64
) -> dict[str, Tensor]:
    """Return every signal that a recording of a kind may have, drawn at random, each (*shape, ...)."""
    random = torch.Generator().manual_seed(seed)

    def between(low: float, high: float, *entries: int) -> Tensor:
        draw = torch.rand((*shape, *entries), generator=random, dtype=torch.float64)
        return (low + (high - low) * draw).to(dtype)

    if kind == "quadrotor":
        return {
            "position": between(0.1, 3.0, 3),
            "attitude": rotations.normalize(between(-1.0, 1.0, 4)),
            "velocity": between(-8.0, 8.0, 3),
            "body_rate": between(-6.0, 6.0, 3),
            "rotor_speed": between(500.0, 2300.0, 4),
            "motor_command": between(0.2, 1.0, 4),
            "battery_voltage": between(12.0, 16.0),
        }
    if kind == "swerve":
        return {
            "chassis_velocity": (twist := between(-3.0, 3.0, 3)),
            "measured_chassis_velocity": twist,
            "heading": between(-3.0, 3.0),
            "steer_angle": between(-3.0, 3.0, 4),
            "steer_velocity": between(-10.0, 10.0, 4),
            "drive_velocity": between(-400.0, 400.0, 4),
            "drive_voltage": between(-12.0, 12.0, 4),
            "steer_voltage": between(-12.0, 12.0, 4),
            "battery_voltage": between(10.0, 13.0),
        }
    return {
        "position": between(-2.0, 2.0),
        "velocity": between(-10.0, 10.0),
        "voltage": between(-12.0, 12.0),
        "battery_voltage": between(10.0, 13.0),
        "temperature": between(20.0, 60.0),
    }


def signals_for(
    effect: Effect, shape: tuple[int, ...], seed: int, dtype: torch.dtype = torch.float64
) -> dict[str, Tensor]:
    """Return signals on which an effect shows: what acts on a command is not seen where its outcome is recorded."""
    signals = some_signals(effect.kind, shape, seed, dtype)
    if "motor_command" in effect.needs:
        del signals["rotor_speed"]
    return signals
