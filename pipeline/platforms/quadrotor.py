"""Quadrotor: a rigid body with four rotors."""

import math
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class Quadrotor:
    """A quadrotor by its nominal parameters; body frame x forward, y left, z up.

    Attributes:
        mass: kg.
        inertia: principal moments [xx, yy, zz], kg·m².
        rotor_positions: four [x, y, z] in the body frame, m.
        rotor_directions: +1 where the rotor's reaction torque on the body is about +z, −1 where about −z.
        thrust_coefficient: thrust over squared rotor speed, N/(rad/s)².
        torque_coefficient: reaction torque over squared rotor speed, N·m/(rad/s)².
        motor_speed_max: rotor speed at a command of 1 and nominal voltage, rad/s.
        nominal_voltage: V.
        gravity: m/s².
        thrust_ratios: each rotor's thrust coefficient over `thrust_coefficient`, with a mean of one; None if all are
            alike.
        torque_ratios: the same of `torque_coefficient`.
    """

    kind: ClassVar[str] = "quadrotor"

    mass: float
    inertia: tuple[float, float, float]
    rotor_positions: tuple[tuple[float, float, float], ...]
    rotor_directions: tuple[int, int, int, int]
    thrust_coefficient: float
    torque_coefficient: float
    motor_speed_max: float
    nominal_voltage: float
    gravity: float = 9.81
    thrust_ratios: tuple[float, float, float, float] | None = None
    torque_ratios: tuple[float, float, float, float] | None = None

    @property
    def hover_rotor_speed(self) -> float:
        """Rotor speed at which four rotors carry the weight, rad/s."""
        return math.sqrt(self.mass * self.gravity / (4.0 * self.thrust_coefficient))
