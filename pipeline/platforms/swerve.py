"""Swerve drive: four modules, each with a drive and a steering motor."""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class DirectCurrentMotor:
    """A direct-current motor by its data sheet.

    Attributes:
        nominal_voltage: V.
        free_speed: rad/s at nominal voltage without load.
        stall_torque: N·m at nominal voltage and standstill.
        stall_current: A at nominal voltage and standstill.
    """

    nominal_voltage: float
    free_speed: float
    stall_torque: float
    stall_current: float

    @property
    def resistance(self) -> float:
        """Winding resistance, Ω."""
        return self.nominal_voltage / self.stall_current

    @property
    def torque_constant(self) -> float:
        """Torque per current, N·m/A."""
        return self.stall_torque / self.stall_current

    @property
    def back_emf_constant(self) -> float:
        """Voltage per speed, V/(rad/s)."""
        return self.nominal_voltage / self.free_speed


@dataclass(frozen=True)
class SwerveAxis:
    """A motor behind a gear.

    Attributes:
        gear_ratio: motor turns per wheel turn (drive) or per module turn (steer).
        motor: the motor's data sheet.
    """

    gear_ratio: float
    motor: DirectCurrentMotor


@dataclass(frozen=True)
class SteerAxis(SwerveAxis):
    """A motor behind a gear that turns a module.

    Attributes:
        inertia: of everything that turns with the module, kg·m² at the module.
    """

    inertia: float


@dataclass(frozen=True)
class Swerve:
    """A swerve drive; robot frame x forward, y left.

    Attributes:
        mass: kg.
        inertia: about z, kg·m².
        module_positions: four [x, y] in the robot frame, m.
        wheel_radius: m.
        drive: the drive axes (all alike).
        steer: the steering axes (all alike).
        gravity: m/s².
    """

    kind: ClassVar[str] = "swerve"

    mass: float
    inertia: float
    module_positions: tuple[tuple[float, float], ...]
    wheel_radius: float
    drive: SwerveAxis
    steer: SteerAxis
    gravity: float = 9.81
