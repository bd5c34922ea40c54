"""Module controllers, based on the platform file alone."""

import numpy as np

from simgap.plants.rotation import Array
from simgap.plants.swerve.case import SwerveCase
from simgap.plants.swerve.reference import Reference
from simgap.platforms import Swerve

_DAMPING_RATIO = 0.8
_SPEED_GAIN = 8.0  # 1/s, of an error of speed into acceleration


class ModuleController:
    """Feedforward by the nominal motors and inertias; proportional on speed, proportional and derivative on angle."""

    def __init__(self, platform: Swerve, case: SwerveCase, reference: Reference) -> None:
        """Prepare the feedforward of all steps."""
        self.platform, self.case = platform, case
        drive, steer = platform.drive, platform.steer
        self.per_speed = drive.motor.back_emf_constant * drive.gear_ratio / platform.wheel_radius
        pull = drive.gear_ratio * drive.motor.torque_constant / platform.wheel_radius
        self.per_pace = 0.25 * platform.mass * drive.motor.resistance / pull
        self.per_rate = steer.motor.back_emf_constant * steer.gear_ratio
        turn = steer.gear_ratio * steer.motor.torque_constant
        self.per_acceleration = steer.inertia * steer.motor.resistance / turn
        self.reference = reference
        self.drive_ahead = self.per_speed * reference.speed + self.per_pace * reference.pace
        self.steer_ahead = self.per_rate * reference.rate + self.per_acceleration * reference.acceleration

    def drive(self, count: int, motor_speed: Array) -> Array:
        """Return the drive voltages (runs, 4), V, at a step, given the motors' speeds (runs, 4), rad/s."""
        drive = self.platform.drive
        seen = motor_speed * (self.platform.wheel_radius / drive.gear_ratio)
        missing = _SPEED_GAIN * (self.reference.speed[count] - seen)
        most = drive.motor.nominal_voltage
        return np.clip(self.drive_ahead[count] + self.per_pace * missing, -most, most)

    def steer(self, count: int, angle: Array, rate: Array) -> Array:
        """Return the steering voltages (runs, 4), V, at a step, given angles, rad, and rates, rad/s, (runs, 4)."""
        bandwidth, reference = self.case.bandwidth, self.reference
        missing = bandwidth * bandwidth * (reference.angle[count] - angle)
        missing = missing + 2.0 * _DAMPING_RATIO * bandwidth * (reference.rate[count] - rate)
        most = self.platform.steer.motor.nominal_voltage
        return np.clip(self.steer_ahead[count] + self.per_acceleration * missing, -most, most)
