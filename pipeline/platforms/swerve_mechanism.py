"""The nominal swerve drive: four wheels that roll without slip, each behind an ideal DC motor."""

from typing import Any

import torch
from torch import Tensor

from pipeline.platforms.mechanism import Channel, Constants, Mechanism, Signals
from pipeline.platforms.swerve import Swerve


class SwerveMechanism(Mechanism):
    """The chassis driven by the wheels' forces, and four steering axes.

    Signals: `drive_voltage`, `steer_voltage`, `drive_velocity` (motor, rad/s), `steer_velocity`, `steer_angle`, each
    (..., 4); `chassis_velocity` (..., 3): [x m/s, y m/s, yaw rad/s] in the robot frame.
    Rolling without slip leaves the wheels' forces undetermined one by one but not their sum, so the drive has three
    equations, those of the chassis: forces in N and a yaw torque in N·m.
    """

    kind = "swerve"
    actuator_signals = ("drive_voltage", "steer_voltage")
    channels = (
        Channel("drive_x", "N", "drive"),
        Channel("drive_y", "N", "drive"),
        Channel("drive_yaw", "N·m", "drive"),
        *(Channel(f"steer_{module}", "N·m", "steer") for module in range(1, 5)),
    )

    def __init__(self, platform: Swerve) -> None:
        self.platform = platform

    def constants(self) -> dict[str, Any]:
        """Return mass, geometry and motors of the platform."""
        platform = self.platform
        constants: dict[str, Any] = {
            "mass": platform.mass,
            "inertia": platform.inertia,
            "wheel_radius": platform.wheel_radius,
            "gravity": platform.gravity,
            "steer_inertia": platform.steer.inertia,
            "sliding_velocity": 0.05,
            "module_positions": torch.tensor(platform.module_positions, dtype=torch.float64),
        }
        for group, axis in (("drive", platform.drive), ("steer", platform.steer)):
            constants[f"{group}_gear_ratio"] = axis.gear_ratio
            constants[f"{group}_resistance"] = axis.motor.resistance
            constants[f"{group}_torque_constant"] = axis.motor.torque_constant
            constants[f"{group}_back_emf_constant"] = axis.motor.back_emf_constant
        return constants

    def actuate(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Turn voltages into torques at the wheel and at the module."""
        out = dict(signals)
        speeds = {
            "drive": signals["drive_velocity"],
            "steer": constants["steer_gear_ratio"] * signals["steer_velocity"],
        }
        for group, speed in speeds.items():
            back_emf = constants[f"{group}_back_emf_constant"] * speed
            current = (signals[f"{group}_voltage"] - back_emf) / constants[f"{group}_resistance"]
            gain = constants[f"{group}_gear_ratio"] * constants[f"{group}_torque_constant"]
            out[f"{group}_torque"] = gain * current
        return out

    def wrench(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Wheel torques summed on the chassis, and steering torques."""
        drive = sum_on_chassis(signals["drive_torque"], signals["steer_angle"], constants)
        return drive | per_module(signals["steer_torque"])

    def inertial(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Transport terms of the turning robot frame."""
        velocity, mass = signals["chassis_velocity"], constants["mass"]
        return {
            "drive_x": mass * velocity[..., 2] * velocity[..., 1],
            "drive_y": -mass * velocity[..., 2] * velocity[..., 0],
        }

    def momentum(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Linear and angular momentum of the chassis, angular momentum of each module."""
        velocity = signals["chassis_velocity"]
        chassis = {
            "drive_x": constants["mass"] * velocity[..., 0],
            "drive_y": constants["mass"] * velocity[..., 1],
            "drive_yaw": constants["inertia"] * velocity[..., 2],
        }
        return chassis | per_module(constants["steer_inertia"] * signals["steer_velocity"])

    def inertia(self, constants: Constants) -> dict[str, float]:
        """Mass, yaw inertia of the chassis, and inertia of each module."""
        mass, yaw, module = (float(constants[name]) for name in ("mass", "inertia", "steer_inertia"))
        chassis = {"drive_x": mass, "drive_y": mass, "drive_yaw": yaw}
        return chassis | {f"steer_{number}": module for number in range(1, 5)}

    def damping(self, constants: Constants) -> dict[str, float]:
        """The back-EMF of four drive motors brakes the chassis, that of a steering motor its module."""
        rates = {}
        for group in ("drive", "steer"):
            gear, resistance = (
                float(constants[f"{group}_gear_ratio"]),
                float(constants[f"{group}_resistance"]),
            )
            product = float(constants[f"{group}_torque_constant"]) * float(
                constants[f"{group}_back_emf_constant"]
            )
            rates[group] = gear**2 * product / resistance
        steer = rates["steer"] / float(constants["steer_inertia"])
        drive = 4.0 * rates["drive"] / (float(constants["wheel_radius"]) ** 2 * float(constants["mass"]))
        return {"drive_x": drive, "drive_y": drive} | {f"steer_{module}": steer for module in range(1, 5)}


def sum_on_chassis(wheel_torque: Tensor, steer_angle: Tensor, constants: Constants) -> dict[str, Tensor]:
    """Sum what four wheel torques do to the chassis.

    Args:
        wheel_torque: about each wheel's axle, (..., 4) N·m.
        steer_angle: (..., 4) rad, zero where the wheel rolls forward.
        constants: with `wheel_radius` m and `module_positions` (4, 2) m.
    """
    force = wheel_torque / constants["wheel_radius"]
    along_x, along_y = force * torch.cos(steer_angle), force * torch.sin(steer_angle)
    positions = constants["module_positions"].to(wheel_torque)
    yaw = (positions[:, 0] * along_y - positions[:, 1] * along_x).sum(-1)
    return {"drive_x": along_x.sum(-1), "drive_y": along_y.sum(-1), "drive_yaw": yaw}


def per_module(values: Tensor) -> dict[str, Tensor]:
    """Name the four steering channels of a (..., 4) tensor."""
    return {f"steer_{module + 1}": values[..., module] for module in range(4)}


def chassis_velocity_from_wheels(drive_velocity: Tensor, steer_angle: Tensor, platform: Swerve) -> Tensor:
    """Least-squares chassis velocity of four rolling wheels (forward kinematics, 8×3 matrix).

    Args:
        drive_velocity: motor speeds, (..., 4) rad/s.
        steer_angle: (..., 4) rad.
        platform: geometry and gearing.

    Returns:
        (..., 3): x m/s, y m/s, yaw rad/s in the robot frame.
    """
    speed = drive_velocity * (platform.wheel_radius / platform.drive.gear_ratio)
    modules = torch.stack([speed * torch.cos(steer_angle), speed * torch.sin(steer_angle)], dim=-1)
    rows = []
    for x, y in platform.module_positions:
        rows += [[1.0, 0.0, -y], [0.0, 1.0, x]]
    inverse = torch.linalg.pinv(torch.tensor(rows, dtype=modules.dtype, device=modules.device))  # (3, 8)
    return modules.flatten(-2) @ inverse.T
