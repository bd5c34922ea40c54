"""Drives of a simulated swerve drive whose modules stand as its motion demands, while voltages shake it."""

import math

import torch
from torch import Tensor

from simgap.platforms import Swerve
from simgap.simulation import Simulator
from simgap.simulation.motion import motion_of
from simgap.simulation.rollout import step

_BANDWIDTH = 30.0  # rad/s, of the modules behind their controllers, critically damped


def waves(runs: int, samples: int, time_step: float, seed: int, rates: tuple[float, ...]) -> Tensor:
    """Return sums of sines with random phases within −1 and 1, (runs, samples); rates in Hz."""
    random = torch.Generator().manual_seed(seed)
    time = torch.arange(samples, dtype=torch.float64) * time_step
    phases = 2.0 * math.pi * torch.rand((runs, 1, len(rates)), generator=random, dtype=torch.float64)
    angles = 2.0 * math.pi * torch.tensor(rates, dtype=torch.float64) * time[:, None] + phases
    return torch.sin(angles).mean(-1)


def module_angles(direction: Tensor, curvature: Tensor, swerve: Swerve) -> Tensor:
    """Return the module angles of a motion along a direction (rad) with so much yaw per metre, (..., 4) rad.

    They do not depend on the speed, so that it may pass through zero; |curvature × position| must stay below one.
    """
    x, y = torch.tensor(swerve.module_positions, dtype=direction.dtype).unbind(-1)
    base, bend = direction[..., None], curvature[..., None]
    turned = torch.atan2(
        bend * (x * torch.cos(base) + y * torch.sin(base)),
        1.0 + bend * (x * torch.sin(base) - y * torch.cos(base)),
    )
    return base + turned


def steering_voltage(signals: dict[str, Tensor], angle: Tensor, rate: Tensor, swerve: Swerve) -> Tensor:
    """Return what lets each module follow an angle: proportional and derivative, with the back-EMF made up for."""
    axis, motor = swerve.steer, swerve.steer.motor
    lag = angle - signals["steer_angle"]
    wanted = _BANDWIDTH**2 * lag + 2.0 * _BANDWIDTH * (rate - signals["steer_velocity"])
    current = axis.inertia * wanted / (axis.gear_ratio * motor.torque_constant)
    back_emf = motor.back_emf_constant * axis.gear_ratio * signals["steer_velocity"]
    return (current * motor.resistance + back_emf).clamp(-motor.nominal_voltage, motor.nominal_voltage)


def driven(
    simulator: Simulator, runs: int, samples: int, time_step: float, seed: int = 0, substeps: int = 4
) -> tuple[Tensor, dict[str, Tensor]]:
    """Return states (runs, samples, n) and the commands held after each, of drives to and fro from standstill.

    Direction and curvature of the motion wander, and the drive voltage goes through zero again and again.
    """
    swerve = simulator.platform
    assert isinstance(swerve, Swerve)
    direction = 3.0 * waves(runs, samples, time_step, seed, (0.11, 0.23, 2.3))
    angle = module_angles(direction, 1.2 * waves(runs, samples, time_step, seed + 1, (0.31, 0.9)), swerve)
    rate = torch.gradient(angle, spacing=time_step, dim=1)[0]
    pull = 9.0 * waves(runs, samples, time_step, seed + 2, (0.4, 0.9, 2.1))
    single = [waves(runs, samples, time_step, seed + 3 + wheel, (1.3, 3.1)) for wheel in range(4)]
    drive = pull[..., None] + torch.stack(single, dim=-1)
    battery = 11.5 + waves(runs, samples, time_step, seed + 7, (0.2, 0.7))
    motion = motion_of(swerve)
    still = torch.zeros(runs, 3, dtype=torch.float64)
    zero = torch.zeros(runs, 4, dtype=torch.float64)
    state = motion.pack({"chassis_velocity": still, "steer_angle": angle[:, 0], "steer_velocity": zero})
    memory, states, steering = (), [], []
    for sample in range(samples):
        signals = motion.signals(state)
        steering.append(steering_voltage(signals, angle[:, sample], rate[:, sample], swerve))
        states.append(state)
        command = {
            "drive_voltage": drive[:, sample],
            "steer_voltage": steering[-1],
            "battery_voltage": battery[:, sample],
        }
        state, memory = step(simulator, state, command, time_step, memory, substeps)
    commands = {"drive_voltage": drive, "steer_voltage": torch.stack(steering, 1), "battery_voltage": battery}
    return torch.stack(states, dim=1), commands
