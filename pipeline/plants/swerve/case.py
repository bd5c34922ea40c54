"""A case of a concealed swerve drive: its physics, motion and recording."""

import math
from dataclasses import dataclass, field

from simgap.checks import check_positive
from simgap.plants.concealment import Concealed, check_chosen
from simgap.plants.conditions import check_gentlest, check_listed, check_logger, check_noise
from simgap.plants.swerve.effects import CONCEALABLE, OUTSIDE
from simgap.platforms import Swerve

MANOEUVRES = ("weave", "spin", "shuttle", "curve", "straight", "cruise", "arena")
RECORDABLE = ("chassis", "battery_voltage", "current")
_TYPICAL = 0.5  # of what is greatest


@dataclass
class SwerveSensors:
    """Standard deviations of white noise, and steps of quantisation.

    Attributes:
        scale: on all figures below; 0 gives perfect sensors.
        drive_velocity: of the motor, rad/s.
        steer_velocity: of the module, rad/s.
        steer_angle: rad.
        steer_angle_step: rad, of an absolute encoder of 12 bits.
        chassis_velocity: m/s.
        chassis_rate: rad/s.
        voltage_step: of the recorded voltages, V, which motor controllers report in whole millivolts.
        battery_voltage: V.
        current: A.
    """

    scale: float = 1.0
    drive_velocity: float = 0.5
    steer_velocity: float = 0.02
    steer_angle: float = 3e-4
    steer_angle_step: float = 1.534e-3
    chassis_velocity: float = 0.01
    chassis_rate: float = 0.005
    voltage_step: float = 0.001
    battery_voltage: float = 0.02
    current: float = 0.3


@dataclass
class SwerveCase:
    """A set of drives of one concealed robot.

    Attributes:
        effects: values by effect of the catalogue and quantity (see `effects.CONCEALABLE`).
        outside: the same for physics that the catalogue has no name for (see `effects.OUTSIDE`).
        manoeuvres: what is driven, in turn over the runs (see `MANOEUVRES`).
        runs: number of runs.
        begins_in_run: run from which on the effects act, counted from 1; those before hold no effect.
        duration: of each run, s.
        rate: of the recording, Hz.
        speed: of the fastest wheel in the fastest run, m/s.
        acceleration: of the same wheel, m/s².
        yaw_rate: greatest, rad/s.
        steering_rate: greatest that directions are laid out for, rad/s.
        gentlest: size of the gentlest run over that of the wildest.
        bandwidth: of the steering loops, rad/s.
        held: whether commands change only when a sample is taken.
        channels: what is recorded besides the motors (see `RECORDABLE`).
        jitter: standard deviation of the sampling instant, s.
        dropped: share of the samples that are lost.
        sensors: noise of the sensors.
    """

    effects: dict[str, dict[str, float]] = field(default_factory=dict)
    outside: dict[str, dict[str, float]] = field(default_factory=dict)
    manoeuvres: list[str] = field(default_factory=lambda: ["weave", "spin", "shuttle", "curve"])
    runs: int = 8
    begins_in_run: int = 1
    duration: float = 10.0
    rate: float = 100.0
    speed: float = 3.0
    acceleration: float = 5.0
    yaw_rate: float = 6.0
    steering_rate: float = 8.0
    gentlest: float = 0.4
    bandwidth: float = 40.0
    held: bool = False
    channels: list[str] = field(default_factory=lambda: ["chassis"])
    jitter: float = 0.0
    dropped: float = 0.002
    sensors: SwerveSensors = field(default_factory=SwerveSensors)

    def check(self, where: str = "record") -> None:
        """Refuse a case that cannot be driven.

        Raises:
            InputError: naming the key.
        """
        check_chosen(self.effects, CONCEALABLE, f"{where}.effects")
        check_chosen(self.outside, OUTSIDE, f"{where}.outside")
        positive = (
            "runs",
            "duration",
            "rate",
            "speed",
            "acceleration",
            "yaw_rate",
            "steering_rate",
            "bandwidth",
        )
        check_positive(self, positive, where)
        check_gentlest(self.gentlest, where)
        check_listed(self.manoeuvres, MANOEUVRES, f"{where}.manoeuvres")
        check_listed(self.channels, RECORDABLE, f"{where}.channels", least=0)
        check_logger(self.rate, self.jitter, self.dropped, where)
        check_noise(self.sensors, f"{where}.sensors")

    def concealed(self, platform: Swerve) -> tuple[Concealed, Concealed]:
        """Return what is concealed in a robot: effects of the catalogue, and those outside it."""
        size = self.size(platform)
        return Concealed(self.effects, CONCEALABLE, size), Concealed(self.outside, OUTSIDE, size)

    def size(self, platform: Swerve) -> dict[str, float]:
        """Return what is typical of the robot in this case: half of what is greatest."""
        force = _TYPICAL * platform.mass * self.acceleration
        wheel_torque = 0.25 * force * platform.wheel_radius
        # The modules swing through their greatest rate about once a second.
        module_torque = _TYPICAL * platform.steer.inertia * self.steering_rate * 2.0 * math.pi
        drive, steer = platform.drive, platform.steer
        return {
            "force": force,
            "wheel_torque": wheel_torque,
            "wheel_speed": _TYPICAL * self.speed / platform.wheel_radius,
            "module_torque": module_torque,
            "module_rate": _TYPICAL * self.steering_rate,
            "drive_current": wheel_torque / (drive.gear_ratio * drive.motor.torque_constant),
            "steer_current": module_torque / (steer.gear_ratio * steer.motor.torque_constant),
            "grip": _TYPICAL * self.acceleration / platform.gravity,
            "track": max(math.hypot(*position) for position in platform.module_positions),
        }
