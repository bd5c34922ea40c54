"""Nominal mechanism of a swerve drive: four wheels that roll without slip, each with an ideal DC motor."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import torch

from simgap.physics.shapes import Channels, PerModule, Real, Signal, Vector
from simgap.platforms.mechanism import Channel, Constants, Mechanism, Signals
from simgap.platforms.swerve import Swerve
from simgap.platforms.swerve_constraint import along_the_wheels, rolling_projection
from simgap.platforms.swerve_kinematics import (
    chassis_twist,
    module_matrix,
    rolling_speed,
    wheel_direction,
)
from simgap.platforms.swerve_slip import (
    CREEP,
    CREEP_ALONG,
    GIVES_WAY,
    SLIDING,
    SPINNING,
    beyond_creep,
    drift_of,
)

_CHASSIS = ("drive_x", "drive_y", "drive_yaw")
MEASURED = "measured_chassis_velocity"
"""The chassis' motion where it was measured by itself and not taken from the wheels, (..., 3)."""
ROLLED = "rolled_chassis_velocity"
"""The chassis' motion where it was taken from the wheels of the platform file, (..., 3); a simulator with other wheels
takes its own from them."""
# A tyre that holds a side force gives way by a hundredth of its speed or two (Pacejka 2012, §1.2).
_ACROSS = {
    "across_x": ("m/s", "rolling", 0.02),
    "across_y": ("m/s", "rolling", 0.02),
    "across_yaw": ("rad/s", "rolling", 0.05),
}


class SwerveMechanism(Mechanism):
    """The chassis driven by the wheels' forces, and four steering axes.

    Signals: `drive_voltage`, `steer_voltage`, `drive_velocity` (motor, rad/s), `steer_velocity`, `steer_angle`, each
    (..., 4); `chassis_velocity` (..., 3): [x m/s, y m/s, yaw rad/s] in the robot frame.
    Rolling without slip leaves the wheels' forces undetermined one by one but not their sum, so the drive has three
    equations, those of the chassis: forces in N and a yaw torque in N·m. Of these, `constrain` keeps what is along the
    motion that the wheels allow; the modules' inertia is small, so that no reaction of it reaches the chassis.
    Where the chassis' motion was measured by itself, it has to agree with the wheels: their motors turn as fast as it
    moves (`rolling_1` to `rolling_4`), and it moves where they let it (`across_x`, `across_y`, `across_yaw`).
    """

    kind = "swerve"
    actuator_signals = ("drive_voltage", "steer_voltage")
    exerted = ("drive_torque", "steer_torque")
    channels = (
        Channel("drive_x", "N", "drive"),
        Channel("drive_y", "N", "drive"),
        Channel("drive_yaw", "N·m", "drive"),
        *(Channel(f"steer_{module}", "N·m", "steer") for module in range(1, 5)),
    )

    wheels = (
        *(Channel(f"rolling_{module}", "rad/s", "rolling") for module in range(1, 5)),
        *(Channel(name, *allowed) for name, allowed in _ACROSS.items()),
    )

    def __init__(self, platform: Swerve) -> None:
        self.platform = platform

    def channels_of(self, signals: Signals) -> tuple[Channel, ...]:
        """Return those of the momenta, and those of the wheels where the chassis' motion was measured by itself."""
        return (*self.channels, *self.wheels) if MEASURED in signals else self.channels

    def free_inertia(self, signals: Signals) -> Channels:
        """The steering motors' share while they cross backlash."""
        if "steer_free_inertia" not in signals:
            return {}
        return {
            f"steer_{module + 1}": free
            for module, free in enumerate(signals["steer_free_inertia"].unbind(-1))
        }

    def readings(self, signals: Signals, constants: Constants) -> dict[str, tuple[Real, Real]]:
        """Return the motors' speeds beside those of the ground below, and the motion beside that along the wheels."""
        if MEASURED not in signals:
            return {}
        twist, angle = signals[MEASURED], wheel_angle(signals["steer_angle"], constants)
        rolls = torch.zeros_like(angle)
        sliding, spinning = signals.get(SLIDING, rolls), signals.get(SPINNING, rolls)
        over = rolling_speed(twist, angle, constants["module_positions"].to(twist))
        per_speed = constants["drive_gear_ratio"] / constants["wheel_radius"]
        creep = GIVES_WAY * torch.hypot(over, over.new_tensor(constants["creep"]))
        motor = per_speed * (over + signals.get(CREEP_ALONG, rolls))
        motor = motor + constants["coupling_ratio"] * signals["steer_velocity"]
        measured = signals["drive_velocity"]
        slip = sliding * beyond_creep((measured - motor) / per_speed, creep)
        least = spinning.abs() * constants["creep"]
        slip = slip + spinning.sign() * (least - spinning.sign() * slip).clamp_min(0.0)
        motor = motor + per_speed * slip
        rolling = {f"rolling_{n + 1}": (measured[..., n], motor[..., n]) for n in range(4)}
        drift = drift_of(signals, angle, constants)
        along = along_the_wheels(twist - drift, angle, constants) + drift
        along = along + sliding.mean(-1, keepdim=True) * beyond_creep(twist - along, constants["creep"])
        across = {name: (twist[..., n], along[..., n]) for n, name in enumerate(_ACROSS)}
        return rolling | across

    def constants(self) -> dict[str, Any]:
        """Return mass, geometry and motors of the platform."""
        return dict(self._constants)

    @cached_property
    def _constants(self) -> dict[str, Any]:
        platform = self.platform
        constants: dict[str, Any] = {
            "mass": platform.mass,
            "inertia": platform.inertia,
            "wheel_radius": platform.wheel_radius,
            "gravity": platform.gravity,
            "steer_inertia": platform.steer.inertia,
            "module_positions": torch.tensor(platform.module_positions, dtype=torch.float64),
            "module_offset": torch.zeros(4, dtype=torch.float64),
            "coupling_ratio": 0.0,
            "creep": CREEP,
        }
        for group, axis in (("drive", platform.drive), ("steer", platform.steer)):
            constants[f"{group}_sliding_velocity"] = 0.05
            constants[f"{group}_gear_ratio"] = axis.gear_ratio
            constants[f"{group}_nominal_voltage"] = axis.motor.nominal_voltage
            constants[f"{group}_resistance"] = axis.motor.resistance
            constants[f"{group}_torque_constant"] = axis.motor.torque_constant
            constants[f"{group}_back_emf_constant"] = axis.motor.back_emf_constant
        return constants

    def actuate(self, signals: Signals, constants: Constants) -> dict[str, Signal]:
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

    def wrench(self, signals: Signals, constants: Constants) -> Channels:
        """Wheel torques summed on the chassis, before the wheels' side forces, and steering torques."""
        drive = sum_on_chassis(signals["drive_torque"], signals["steer_angle"], constants)
        return drive | per_module(steering_torque(signals, constants))

    def loads(self, wrench: Mapping[str, Real], signals: Signals) -> dict[str, Signal]:
        """All that acts on each module about its axis, and each motor's torque about its wheel's axle, (..., 4) N·m."""
        modules = torch.stack([wrench[name] for name in per_module(signals["drive_torque"])], dim=-1)
        return {"wheel_load": signals["drive_torque"], "module_load": modules}

    def derived(self, signals: Signals, constants: Constants) -> dict[str, Signal]:
        """Return the chassis' motion, the projection onto the motion that the wheels allow, and its rate."""
        angle = wheel_angle(signals["steer_angle"], constants)
        projection, rate = rolling_projection(angle, signals["steer_velocity"], constants)
        return {
            "chassis_velocity": _twist(signals, constants),
            "rolling_projection": projection,
            "rolling_projection_rate": rate,
        }

    def constrain(self, wrench: Mapping[str, Real], signals: Signals, constants: Constants) -> Channels:
        """Add the wheels' side forces, which leave what is along the motion that the wheels allow."""
        if not wrench.keys() & set(_CHASSIS):
            return dict(wrench)
        zero = torch.zeros_like(signals["steer_angle"][..., 0])
        whole = torch.stack([wrench.get(name, zero) for name in _CHASSIS], dim=-1)
        projection = self._projection(signals, constants)["rolling_projection"]
        return {**wrench, **on_chassis((projection @ whole[..., None])[..., 0])}

    def inertial(self, signals: Signals, constants: Constants) -> Channels:
        """Transport terms of the turning robot frame along the allowed motion, and what turns the motion with it."""
        velocity, mass = signals["chassis_velocity"], constants["mass"]
        x, y, yaw = velocity.unbind(-1)
        transport = mass * torch.stack([yaw * y, -yaw * x, torch.zeros_like(yaw)], dim=-1)
        momentum = torch.stack([mass * x, mass * y, constants["inertia"] * yaw], dim=-1)
        known = self._projection(signals, constants)
        projection, rate = known["rolling_projection"], known["rolling_projection_rate"]
        return on_chassis((projection @ transport[..., None] + rate @ momentum[..., None])[..., 0])

    def _projection(self, signals: Signals, constants: Constants) -> Signals:
        return signals if "rolling_projection" in signals else self.derived(signals, constants)

    def momentum(self, signals: Signals, constants: Constants) -> Channels:
        """Linear and angular momentum of the chassis, angular momentum of each module."""
        velocity = _twist(signals, constants)
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


def wheel_angle(steer_angle: PerModule, constants: Constants) -> PerModule:
    """Return the true angle of each wheel, (..., 4) rad: the measured angle plus its misalignment."""
    return steer_angle + constants["module_offset"].to(steer_angle)


def steering_torque(signals: Signals, constants: Constants) -> PerModule:
    """Return the motor torque about each module's axis, (..., 4) N·m, with the reaction of the drive's gears."""
    coupling = constants["coupling_ratio"] / constants["drive_gear_ratio"]
    return signals["steer_torque"] + coupling * signals["drive_torque"]


def sum_on_chassis(wheel_torque: PerModule, steer_angle: PerModule, constants: Constants) -> Channels:
    """Return the force and yaw torque of four wheel torques on the chassis.

    Args:
        wheel_torque: about each wheel's axle, (..., 4) N·m.
        steer_angle: (..., 4) rad, zero where the wheel rolls forward.
        constants: with `wheel_radius` m, `module_positions` (4, 2) m and `module_offset` (4,) rad.
    """
    force = (wheel_torque / constants["wheel_radius"])[..., None] * wheel_direction(
        wheel_angle(steer_angle, constants)
    )
    return on_chassis(force.flatten(-2) @ module_matrix(constants["module_positions"].to(wheel_torque)))


def on_chassis(vector: Vector) -> Channels:
    """Name the three components of a (..., 3) vector as channels of the chassis."""
    return {name: vector[..., index] for index, name in enumerate(_CHASSIS)}


def per_module(values: PerModule) -> Channels:
    """Name the four steering channels of a (..., 4) tensor."""
    return {f"steer_{module + 1}": values[..., module] for module in range(4)}


def twist_from_wheels(signals: Signals, constants: Constants) -> Vector:
    """Return the chassis' motion that four rolling wheels fit best in the least-squares sense.

    Args:
        signals: with `drive_velocity` of the motors, rad/s, `steer_velocity`, rad/s, and `steer_angle`, rad, (..., 4)
            each.
        constants: with `wheel_radius` m, `drive_gear_ratio`, `coupling_ratio`, `module_positions` (4, 2) m and
            `module_offset` (4,) rad.

    Returns:
        (..., 3): x m/s, y m/s, yaw rad/s in the robot frame.
    """
    turning = signals["drive_velocity"] - constants["coupling_ratio"] * signals["steer_velocity"]
    speed = turning * (constants["wheel_radius"] / constants["drive_gear_ratio"])
    direction = wheel_direction(wheel_angle(signals["steer_angle"], constants))
    return chassis_twist(speed[..., None] * direction, constants["module_positions"])


def _twist(signals: Signals, constants: Constants) -> Vector:
    """Return the chassis' motion as it was measured, or as the wheels of a simulator roll, (..., 3)."""
    return twist_from_wheels(signals, constants) if ROLLED in signals else signals["chassis_velocity"]
