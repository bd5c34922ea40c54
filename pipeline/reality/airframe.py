"""The concealed quadrotor as a rigid body with four rotors in the air."""

from dataclasses import dataclass, replace

import numpy as np

from pipeline.reality.rotation import Array, cross
from pipeline.reality.rotor import AIR_DENSITY, NEWTON_STEPS, Rotor

# Unlike the catalogue's body drag, a real frame shows the wind a different face along each axis.
FACES = np.array([0.9, 1.0, 1.15])


@dataclass(frozen=True)
class Airframe:
    """What the plant truly is.

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

    def wrench(
        self, velocity: Array, body_rate: Array, rotor_speed: Array, inflow: Array, steps: int = NEWTON_STEPS
    ) -> tuple[Array, Array, Array]:
        """Return specific force, torque and induced velocities.

        Args:
            velocity: body frame, (..., 3) m/s.
            body_rate: (..., 3) rad/s.
            rotor_speed: (..., 4) rad/s.
            inflow: the last induced velocities (2, ..., 4), m/s.
            steps: of Newton's rule for the induced velocities.

        Returns:
            Specific force (..., 3) m/s² and torque (..., 3) N·m, body frame; induced velocities.
        """
        hubs = velocity[..., None, :] + cross(body_rate[..., None, :], self.arm * self.rotor_positions)
        thrust, in_plane, inflow = self.rotor.forces(rotor_speed, hubs, inflow, steps)
        forces = np.concatenate((in_plane, thrust[..., None]), axis=-1)  # (..., 4, 3)
        twisting = np.concatenate((self.arm * in_plane, thrust[..., None]), axis=-1)
        torque = cross(self.rotor_positions, twisting).sum(axis=-2)
        torque[..., 2] += (rotor_speed * rotor_speed) @ (self.torque_coefficient * self.rotor_directions)
        airspeed = np.sqrt((velocity * velocity).sum(axis=-1, keepdims=True))
        drag = -0.5 * AIR_DENSITY * self.drag_area * FACES * airspeed * velocity
        return (forces.sum(axis=-2) + drag) / self.mass, torque, inflow

    def settled(self, velocity: Array, body_rate: Array, rotor_speed: Array) -> tuple[Array, Array]:
        """Return specific force and torque, as `wrench`, with the induced velocities settled."""
        inflow = self.rotor.still_inflow(rotor_speed)
        return self.wrench(velocity, body_rate, rotor_speed, inflow, steps=30)[:2]

    def without(self, effect: str) -> "Airframe":
        """Return the same airframe with one of its forces or torques switched off."""
        if effect == "body_drag":
            return replace(self, drag_area=0.0)
        if effect == "angular_drag":
            return replace(self, arm=0.0)
        return replace(self, rotor=replace(self.rotor, **{ROTOR_SWITCHES[effect]: 0.0}))


ROTOR_SWITCHES = {
    "rotor_drag": "lateral_scale",
    "axial_inflow": "axial_share",
    "translational_lift": "in_plane_share",
}
"""The attribute of the rotor by which each of its effects is switched off."""
