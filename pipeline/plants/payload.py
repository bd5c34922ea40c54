"""A load on a cable below the machine's centre of mass: a spherical pendulum in full, coupled with the vehicle.

Sreenath, Lee & Kumar 2013, "Geometric control and differential flatness of a quadrotor UAV with a cable-suspended
load", equations (5)–(9), with air drag on the load. The cable is taut and has no mass.
"""

import math

import numpy as np

from simgap.plants.integration import AdamsBashforth
from simgap.plants.rotation import Array
from simgap.plants.rotor import AIR_DENSITY

_DENSITY = 1000.0  # kg/m³ of the load, a sphere
_SPHERE_DRAG = 0.47


class Payload:
    """The loads of all runs, hanging still at first.

    Attributes:
        direction: unit vector from machine to load (runs, 3), world frame.
        swing: its rate of change (runs, 3), 1/s.
    """

    def __init__(self, vehicle_mass: float, mass: float, length: float, runs: int, step: float) -> None:
        """Hang the loads on.

        Args:
            vehicle_mass: kg.
            mass: of the load, kg.
            length: of the cable, m.
            runs: how many.
            step: s.
        """
        self.vehicle_mass, self.mass, self.length = vehicle_mass, mass, length
        radius = (3.0 * mass / (4.0 * math.pi * _DENSITY)) ** (1.0 / 3.0)
        self.drag = 0.5 * AIR_DENSITY * _SPHERE_DRAG * math.pi * radius**2
        self.direction = np.tile([0.0, 0.0, -1.0], (runs, 1))
        self.swing = np.zeros((runs, 3))
        self.advance = AdamsBashforth(step)

    def pull(self, force: Array, airspeed: Array) -> Array:
        """Return the cable's force on the machine and swing on for a step.

        Args:
            force: on the machine but for gravity and cable, world frame (runs, 3), N.
            airspeed: velocity of the machine through the air, world frame (runs, 3), m/s.

        Returns:
            World frame (runs, 3), N.
        """
        direction, swing = self.direction, self.swing
        through = airspeed + self.length * swing
        drag = -self.drag * np.sqrt((through * through).sum(axis=-1, keepdims=True)) * through
        apart = drag / self.mass - force / self.vehicle_mass
        centripetal = self.length * (swing * swing).sum(axis=-1, keepdims=True)
        reduced = 1.0 / (1.0 / self.mass + 1.0 / self.vehicle_mass)
        tension = reduced * (centripetal + (apart * direction).sum(axis=-1, keepdims=True))
        quickening = (apart - tension / reduced * direction) / self.length
        state = self.advance(np.stack((direction, swing)), np.stack((swing, quickening)))
        self.direction = state[0] / np.sqrt((state[0] * state[0]).sum(axis=-1, keepdims=True))
        self.swing = state[1] - (state[1] * self.direction).sum(axis=-1, keepdims=True) * self.direction
        return tension * direction
