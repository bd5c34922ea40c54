"""Blade-element rotor with induced inflow.

Leishman 2006, "Principles of Helicopter Aerodynamics": blade elements of constant pitch and chord
(§3.2), flapping (§4.4), momentum theory with Glauert's rule for oblique flow (§2.14). In still air thrust
is exactly quadratic in speed.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from simgap.plants.rotation import Array

AIR_DENSITY = 1.225  # kg/m³, sea level, 15 °C
_STILL = 1e-6  # m/s, below which air does not move
NEWTON_STEPS = 2  # per evaluation from the last inflow, enough at a thousand evaluations a second


@dataclass(frozen=True)
class Rotor:
    """Blades of a rotor, and its share of the body's airspeed.

    Attributes:
        thrust_coefficient: in still air, N/(rad/s)².
        radius: m.
        solidity: blade area over disc area.
        lift_slope: of the blade section, 1/rad.
        profile_drag: coefficient of the blade section.
        lateral_scale: on the in-plane force; 0 switches it off.
        axial_share: of the flow along the axis that changes the thrust; 0 switches it off.
        in_plane_share: of the flow through the disc's plane that changes the thrust; 0 switches it off.
        hub_stiffness: moment on the hub per tilt of the disc and squared speed, N·m/(rad/s)²; the centrifugal
            force on hinges away from the axis grows with the square of speed.
    """

    thrust_coefficient: float
    radius: float
    solidity: float = 0.2
    lift_slope: float = 5.0
    profile_drag: float = 0.03
    lateral_scale: float = 0.0
    axial_share: float = 0.0
    in_plane_share: float = 0.0
    hub_stiffness: float = 0.0

    @cached_property
    def area(self) -> float:
        """Disc area, m²."""
        return math.pi * self.radius**2

    @cached_property
    def still_inflow_ratio(self) -> float:
        """Induced velocity over tip speed in still air."""
        return math.sqrt(self.thrust_coefficient / (2 * AIR_DENSITY * self.area)) / self.radius

    @cached_property
    def lift_factor(self) -> float:
        """½·density·solidity·area·lift slope, N/(m/s)²."""
        return 0.5 * AIR_DENSITY * self.solidity * self.area * self.lift_slope

    @cached_property
    def pitch(self) -> float:
        """Blade pitch that gives the thrust coefficient in still air, rad."""
        loading = self.thrust_coefficient / (self.radius**2 * self.lift_factor)
        return 3.0 * (loading + 0.5 * self.still_inflow_ratio)

    def still_inflow(self, speed: Array) -> Array:
        """Return the induced velocity in still air of both flows of `forces`, (2, ...), m/s."""
        induced = self.still_inflow_ratio * self.radius * speed
        return np.stack((induced, induced))

    def forces(
        self, speed: Array, hub_velocity: Array, inflow: Array, steps: int = NEWTON_STEPS
    ) -> tuple[Array, Array, Array]:
        """Return thrust along the axis, in-plane force and induced velocity.

        Args:
            speed: (...,) rad/s.
            hub_velocity: through the air, body frame, (..., 3) m/s.
            inflow: the last induced velocities (2, ...), m/s: in the full flow, which the in-plane force
                feels, and in the share of it that the thrust feels.
            steps: of Newton's rule.

        Returns:
            Thrust (...,) N; in-plane force (..., 2) N; induced velocities (2, ...) m/s.
        """
        in_plane = hub_velocity[..., :2]
        crossing = np.sqrt((in_plane * in_plane).sum(axis=-1))
        climbing = hub_velocity[..., 2]
        crossings = np.stack((crossing, self.in_plane_share * crossing))
        climbs = np.stack((climbing, self.axial_share * climbing))
        tip = self.radius * speed
        inflow = self._induced(tip, crossings, climbs, inflow, steps)
        thrust = self._lift(tip, crossings[1], climbs[1] + inflow[1])
        resistance = self._resistance(tip, (climbs[0] + inflow[0]) / tip, thrust)
        return thrust, -self.lateral_scale * resistance[..., None] * in_plane, inflow

    def _lift(self, tip: Array, crossing: Array, through: Array) -> Array:
        """Thrust of the blade elements, N, with `through` m/s of air through the disc."""
        pitched = self.pitch * (tip * tip / 3.0 + 0.5 * crossing * crossing)
        return self.lift_factor * (pitched - 0.5 * tip * through)

    def _induced(self, tip: Array, crossing: Array, climb: Array, inflow: Array, steps: int) -> Array:
        """Induced velocity at which blade elements and momentum agree on the thrust, m/s."""
        mass_flow = 2.0 * AIR_DENSITY * self.area
        lift_slope = 0.5 * self.lift_factor * tip
        unloaded = self._lift(tip, crossing, climb)
        squared = crossing * crossing
        for _ in range(steps):
            through = climb + inflow
            resultant = np.maximum(np.sqrt(squared + through * through), _STILL)
            excess = unloaded - lift_slope * inflow - mass_flow * inflow * resultant
            slope = lift_slope + mass_flow * np.maximum(resultant + inflow * through / resultant, 0.0)
            inflow = np.maximum(inflow + excess / slope, 0.0)
        return inflow

    def _resistance(self, tip: Array, inflow_ratio: Array, thrust: Array) -> Array:
        """In-plane force per in-plane airspeed: blade drag, tilted lift and tilt by flapping, N/(m/s)."""
        section = self.pitch * inflow_ratio + self.profile_drag / self.lift_slope
        blades = 0.5 * self.lift_factor * tip * section
        return blades + thrust * self._tilt(tip, inflow_ratio)

    def _tilt(self, tip: Array, inflow_ratio: Array) -> Array:
        """Backward tilt of the disc per in-plane airspeed, rad/(m/s)."""
        return (8.0 / 3.0 * self.pitch - 2.0 * inflow_ratio) / tip

    def hub_moment(self, speed: Array, induced: Array, climb: Array) -> Array:
        """Return the moment of a tilted disc on its hub per in-plane airspeed, N·s.

        Args:
            speed: (...,) rad/s.
            induced: velocity in the full flow (...,), m/s.
            climb: of the hub through the air (...,), m/s.
        """
        tip = self.radius * speed
        return self.hub_stiffness * speed * speed * self._tilt(tip, (climb + induced) / tip)
