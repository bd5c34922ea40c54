"""The autopilot of the concealed quadrotor: position, attitude and body rate in a cascade.

After Lee, Leok & McClamroch 2010, "Geometric tracking control of a quadrotor UAV on SE(3)". It knows only the
platform file, never what is concealed: like a real one's, its feedback hides the effects in the commands.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.platforms import Quadrotor
from pipeline.reality.rotation import Array, cross


@dataclass(frozen=True)
class Gains:
    """Gains by mass and inertia, so that they suit a machine of any size.

    Attributes:
        position: 1/s².
        velocity: 1/s.
        attitude: 1/s.
        body_rate: 1/s.
        idle: least rotor speed over the greatest.
    """

    position: float = 6.0
    velocity: float = 4.0
    attitude: float = 9.0
    body_rate: float = 25.0
    idle: float = 0.08


class Controller:
    """Turns references and estimates into commanded rotor speeds."""

    def __init__(self, platform: Quadrotor, gains: Gains | None = None) -> None:
        """Allocate the wrench to the rotors as the platform file has them."""
        self.platform = platform
        self.gains = gains or Gains()
        self.inertia = np.array(platform.inertia)
        positions = np.array(platform.rotor_positions)
        lift = platform.thrust_coefficient * np.ones(4)
        reaction = platform.torque_coefficient * np.array(platform.rotor_directions)
        mixer = np.stack((lift, lift * positions[:, 1], -lift * positions[:, 0], reaction))
        self.allocation = np.linalg.inv(mixer).T  # wrench (..., 4) @ allocation gives squared rotor speeds

    def command(
        self,
        reference: Sequence[Array],
        position: Array,
        velocity: Array,
        rotation: Array,
        body_rate: Array,
        dither: Array,
    ) -> Array:
        """Return commanded rotor speeds (runs, 4), rad/s.

        Args:
            reference: position and heading (runs, 4), and their first and second derivatives.
            position: (runs, 3) m.
            velocity: world frame, (runs, 3) m/s.
            rotation: body to world, (runs, 3, 3).
            body_rate: (runs, 3) rad/s.
            dither: added to mass-normalised thrust, m/s², and body rates, rad/s; (runs, 4).
        """
        target, speed, quickening = reference
        gains, platform = self.gains, self.platform
        wanted = (
            quickening[:, :3]
            + gains.velocity * (speed[:, :3] - velocity)
            + gains.position * (target[:, :3] - position)
        )
        wanted[:, 2] += platform.gravity
        thrust = platform.mass * ((wanted * rotation[:, :, 2]).sum(axis=-1) + dither[:, 0])
        turn = gains.attitude * self._attitude_error(wanted, target[:, 3], rotation) + dither[:, 1:]
        turn += rotation[:, 2, :] * speed[:, 3:]  # the heading's rate about the vertical, in the body frame
        momentum = self.inertia * body_rate
        torque = self.inertia * gains.body_rate * (turn - body_rate) + cross(body_rate, momentum)
        squared = np.concatenate((thrust[:, None], torque), axis=-1) @ self.allocation
        greatest = platform.motor_speed_max
        return np.sqrt(np.clip(squared, (gains.idle * greatest) ** 2, greatest**2))

    def _attitude_error(self, wanted: Array, heading: Array, rotation: Array) -> Array:
        """Return the turn (runs, 3), body frame, of the thrust to `wanted` and of the nose to `heading`."""
        up = wanted / np.sqrt((wanted * wanted).sum(axis=-1, keepdims=True))
        nose = np.stack((np.cos(heading), np.sin(heading), np.zeros_like(heading)), axis=-1)
        left = cross(up, nose)
        left /= np.sqrt((left * left).sum(axis=-1, keepdims=True))
        desired = np.stack((cross(left, up), left, up), axis=-1)  # body axes as columns
        error = rotation.transpose(0, 2, 1) @ desired
        error = error - error.transpose(0, 2, 1)
        return 0.5 * np.stack((error[:, 2, 1], error[:, 0, 2], error[:, 1, 0]), axis=-1)
