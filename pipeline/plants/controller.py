"""The autopilot of the concealed quadrotor: position, attitude and body rate in a cascade.

After Lee, Leok & McClamroch 2010, "Geometric tracking control of a quadrotor UAV on SE(3)". It knows only the
platform file, never what is concealed: like a real one's, its feedback hides the effects in the commands.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from simgap.plants.case import PlantCase
from simgap.plants.rotation import Array, cross
from simgap.platforms import Quadrotor

_PHASE = 0.6  # rad that motors may cost the rate loop where it crosses over
_POSITION_INTEGRAL, _RATE_INTEGRAL = 4.0, 60.0  # 1/s³ and 1/s²
_MOST_PUSH, _MOST_TWIST = 8.0, 60.0  # m/s² and rad/s² that the integrals may ask for


@dataclass(frozen=True)
class Gains:
    """Gains by mass and inertia, so that they suit a machine of any size.

    Attributes:
        position: 1/s².
        velocity: 1/s.
        attitude: 1/s.
        body_rate: 1/s.
        position_integral: 1/s³; 0 for none.
        rate_integral: 1/s²; 0 for none.
        yaw_cut_off: of a low-pass on the yaw torque, rad/s; infinite for none.
        idle: least rotor speed over the greatest.
    """

    position: float = 6.0
    velocity: float = 4.0
    attitude: float = 9.0
    body_rate: float = 25.0
    position_integral: float = 0.0
    rate_integral: float = 0.0
    yaw_cut_off: float = math.inf
    idle: float = 0.08


def tuned(case: PlantCase, platform: Quadrotor) -> Gains:
    """Return the gains that a pilot would have found for the machine of a case.

    Integrals carry what stays wrong. Motors that answer late get gains in proportion. Where rotors are heavy, yaw is
    commanded no faster than at the frequency above which their inertia twists the body more than the air does.
    """
    if not case.trimmed:
        return Gains()
    plain = Gains()
    late = case.strength("motor_lag") + case.strength("command_delay")
    slower = min(1.0, _PHASE / (plain.body_rate * late)) if late > 0 else 1.0
    inertia = case.strength("rotor_inertia_torque")
    by_air = 2.0 * platform.torque_coefficient * platform.hover_rotor_speed  # N·m/(rad/s)
    return Gains(
        position=plain.position * slower**2,
        velocity=plain.velocity * slower,
        attitude=plain.attitude * slower,
        body_rate=plain.body_rate * slower,
        position_integral=_POSITION_INTEGRAL * slower**3,
        rate_integral=_RATE_INTEGRAL * slower**2,
        yaw_cut_off=by_air / inertia if inertia > 0 else math.inf,
    )


class Controller:
    """Turns references and estimates into commanded rotor speeds; call `command` once a step."""

    def __init__(self, platform: Quadrotor, gains: Gains | None = None, step: float = 1e-3) -> None:
        """Allocate the wrench to the rotors as the platform file has them; the step is in s."""
        self.platform = platform
        self.gains = gains or Gains()
        self.step = step
        self.inertia = np.array(platform.inertia)
        positions = np.array(platform.rotor_positions)
        lift = platform.thrust_coefficient * np.ones(4)
        reaction = platform.torque_coefficient * np.array(platform.rotor_directions)
        mixer = np.stack((lift, lift * positions[:, 1], -lift * positions[:, 0], reaction))
        self.allocation = np.linalg.inv(mixer).T  # wrench (..., 4) @ allocation gives squared rotor speeds
        self.place_trim: Array | float = 0.0  # m/s²
        self.turn_trim: Array | float = 0.0  # rad/s²
        self.yaw_torque: Array | float = 0.0  # N·m

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
        if gains.position_integral > 0:
            gained = self.step * gains.position_integral * (target[:, :3] - position)
            self.place_trim = np.clip(self.place_trim + gained, -_MOST_PUSH, _MOST_PUSH)
            wanted += self.place_trim
        wanted[:, 2] += platform.gravity
        thrust = platform.mass * ((wanted * rotation[:, :, 2]).sum(axis=-1) + dither[:, 0])
        turn = gains.attitude * self._attitude_error(wanted, target[:, 3], rotation) + dither[:, 1:]
        turn += rotation[:, 2, :] * speed[:, 3:]  # the heading's rate about the vertical, in the body frame
        return self.rotors(thrust, turn, body_rate)

    def rotors(self, thrust: Array, turn: Array, body_rate: Array) -> Array:
        """Return commanded rotor speeds (runs, 4), rad/s.

        Args:
            thrust: (runs,) N.
            turn: wanted body rates (runs, 3), rad/s.
            body_rate: measured ones (runs, 3), rad/s.
        """
        gains, platform = self.gains, self.platform
        momentum = self.inertia * body_rate
        torque = self.inertia * gains.body_rate * (turn - body_rate) + cross(body_rate, momentum)
        self._trim(torque, turn - body_rate)
        squared = np.concatenate((thrust[:, None], torque), axis=-1) @ self.allocation
        greatest = platform.motor_speed_max
        return np.sqrt(np.clip(squared, (gains.idle * greatest) ** 2, greatest**2))

    def _trim(self, torque: Array, rate_error: Array) -> None:
        """Add the integral of the rate error (runs, 3), rad/s, to the torque and low-pass its yaw, in place."""
        if self.gains.rate_integral > 0:
            gained = self.step * self.gains.rate_integral * rate_error
            self.turn_trim = np.clip(self.turn_trim + gained, -_MOST_TWIST, _MOST_TWIST)
            torque += self.inertia * self.turn_trim
        if self.gains.yaw_cut_off < math.inf:
            share = 1.0 - math.exp(-self.step * self.gains.yaw_cut_off)
            self.yaw_torque = self.yaw_torque + share * (torque[:, 2] - self.yaw_torque)
            torque[:, 2] = self.yaw_torque

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
