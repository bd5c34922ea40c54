"""Airframe of the concealed quadrotor: a rigid body with four rotors."""

from dataclasses import dataclass, field, replace

import numpy as np

from simgap.plants.rotation import Array, cross
from simgap.plants.rotor import AIR_DENSITY, NEWTON_STEPS, Rotor

# Unlike the catalogue's body drag, a real frame shows the wind a different face along each axis,
FACES = np.array([0.9, 1.0, 1.15])
# and resists turning about its long axis the most, a little more so the faster it turns.
TURNING_FACES = np.array([0.95, 1.0, 1.1])
_TURNING_GROWTH = 0.05  # s/rad
_GREATEST_GAIN = 0.5  # of the ground effect's term R²/16h²: nearer to the floor its theory ends


@dataclass(frozen=True)
class Airframe:
    """True parameters of the plant.

    Attributes:
        mass: kg.
        inertia: principal moments (3,), kg·m².
        rotor_positions: (4, 3) m.
        rotor_directions: (4,) sense of the reaction torque on the body.
        torque_coefficient: N·m/(rad/s)².
        rotor: the blades, alike for all four.
        drag_area: drag coefficient times area, m².
        arm: share of the hubs' distance from the centre of mass over which the body's turning moves them
            through the air and their in-plane forces twist the body.
        gravity: m/s².
        center: of mass, from where the rotors' places are measured, (3,) m.
        lift_share: each rotor's thrust and reaction torque over those of an even and whole rotor, (4,).
        lean: of each rotor's thrust along body x and y over its size, (4, 2).
        ground_area: of the ground effect, R²/16 with the radius R that the floor sees, m².
        turning_resistance: of the frame in the air, N·m·s/rad.
    """

    mass: float
    inertia: Array
    rotor_positions: Array
    rotor_directions: Array
    torque_coefficient: float
    rotor: Rotor
    drag_area: float
    arm: float
    gravity: float
    center: Array = field(default_factory=lambda: np.zeros(3))
    lift_share: Array = field(default_factory=lambda: np.ones(4))
    lean: Array = field(default_factory=lambda: np.zeros((4, 2)))
    ground_area: float = 0.0
    turning_resistance: float = 0.0

    def wrench(
        self,
        velocity: Array,
        body_rate: Array,
        rotor_speed: Array,
        inflow: Array,
        steps: int = NEWTON_STEPS,
        height: Array | None = None,
    ) -> tuple[Array, Array, Array]:
        """Return specific force, torque and induced velocities.

        Args:
            velocity: through the air, body frame, (..., 3) m/s.
            body_rate: (..., 3) rad/s.
            rotor_speed: (..., 4) rad/s.
            inflow: the last induced velocities (2, ..., 4), m/s.
            steps: of Newton's rule for the induced velocities.
            height: over the floor (...,), m, one for all rotors, whose jets meet there; None far from it.

        Returns:
            Specific force (..., 3) m/s² and torque (..., 3) N·m, body frame; induced velocities.
        """
        places = self.rotor_positions - self.center
        hubs = velocity[..., None, :] + cross(body_rate[..., None, :], self.arm * places)
        thrust, in_plane, inflow = self.rotor.forces(rotor_speed, hubs, inflow, steps)
        if height is not None and self.ground_area > 0:
            thrust = thrust * self._ground_gain(height[..., None], hubs, inflow[0])
        thrust, in_plane = self.lift_share * thrust, self.lift_share[:, None] * in_plane
        leaning = thrust[..., None] * self.lean
        forces = np.concatenate((in_plane + leaning, thrust[..., None]), axis=-1)  # (..., 4, 3)
        twisting = np.concatenate((self.arm * in_plane + leaning, thrust[..., None]), axis=-1)
        torque = cross(places, twisting).sum(axis=-2)
        reaction = self.torque_coefficient * self.rotor_directions * self.lift_share
        torque[..., 2] += (rotor_speed * rotor_speed) @ reaction
        torque += self._hub_moments(rotor_speed, hubs, inflow) + self._turning_drag(body_rate)
        airspeed = np.sqrt((velocity * velocity).sum(axis=-1, keepdims=True))
        drag = -0.5 * AIR_DENSITY * self.drag_area * FACES * airspeed * velocity
        return (forces.sum(axis=-2) + drag) / self.mass, torque, inflow

    def _ground_gain(self, height: Array, hubs: Array, induced: Array) -> Array:
        """Return thrust over that far from the floor: Cheeseman & Bennett 1955, equation (7)."""
        crossing = (hubs[..., 0] ** 2 + hubs[..., 1] ** 2) / (induced * induced)
        nearest = np.sqrt(self.ground_area / _GREATEST_GAIN)
        squared = np.maximum(height, nearest) ** 2
        return 1.0 / (1.0 - self.ground_area / squared / (1.0 + crossing))

    def _hub_moments(self, rotor_speed: Array, hubs: Array, inflow: Array) -> Array | float:
        if self.rotor.hub_stiffness == 0:
            return 0.0
        per_speed = (self.lift_share * self.rotor.hub_moment(rotor_speed, inflow[0], hubs[..., 2]))[..., None]
        turned = np.stack((hubs[..., 1], -hubs[..., 0], np.zeros_like(hubs[..., 0])), axis=-1)
        return (per_speed * turned).sum(axis=-2)

    def _turning_drag(self, body_rate: Array) -> Array | float:
        if self.turning_resistance == 0:
            return 0.0
        rate = np.sqrt((body_rate * body_rate).sum(axis=-1, keepdims=True))
        return -self.turning_resistance * TURNING_FACES * (1.0 + _TURNING_GROWTH * rate) * body_rate

    def settled(
        self, velocity: Array, body_rate: Array, rotor_speed: Array, height: Array | None = None
    ) -> tuple[Array, Array]:
        """Return specific force and torque, as `wrench`, with the induced velocities settled."""
        inflow = self.rotor.still_inflow(rotor_speed)
        return self.wrench(velocity, body_rate, rotor_speed, inflow, 30, height)[:2]

    def without(self, effect: str) -> "Airframe":
        """Return the same airframe with one of its forces or torques switched off."""
        if effect == "body_drag":
            return replace(self, drag_area=0.0)
        if effect == "angular_drag":
            return replace(self, arm=0.0, turning_resistance=0.0)
        if effect == "ground_effect":
            return replace(self, ground_area=0.0)
        return replace(self, rotor=replace(self.rotor, **{ROTOR_SWITCHES[effect]: 0.0}))


ROTOR_SWITCHES = {
    "rotor_drag": "lateral_scale",
    "axial_inflow": "axial_share",
    "translational_lift": "in_plane_share",
    "blade_flapping_moment": "hub_stiffness",
}
"""The attribute of the rotor by which each of its effects is switched off."""
