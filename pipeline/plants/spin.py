"""Angular momentum of the rotors and its reaction on the body."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.rotation import Array


@dataclass(frozen=True)
class Spin:
    """Euler's equation of a body that carries spinning rotors: J·dω/dt + ω × J·ω = τ − dh/dt − ω × h.

    Both inertias are the same in nature; apart, they let either torque be concealed alone.

    Attributes:
        directions: (4,) sense of the reaction torque on the body; a rotor spins the other way.
        accelerating: inertia of a rotor that resists changes of its speed, kg·m².
        tilting: inertia of a rotor that resists the turning of its axis, kg·m².
    """

    directions: Array
    accelerating: float
    tilting: float

    def torque(self, speed: Array, acceleration: Array, body_rate: Array) -> Array:
        """Return what the rotors' inertia does to the body, (..., 3) N·m.

        Args:
            speed: (..., 4) rad/s.
            acceleration: (..., 4) rad/s².
            body_rate: (..., 3) rad/s.
        """
        momentum = -self.tilting * (speed @ self.directions)
        torque = np.empty_like(body_rate)
        torque[..., 0] = -body_rate[..., 1] * momentum
        torque[..., 1] = body_rate[..., 0] * momentum
        torque[..., 2] = self.accelerating * (acceleration @ self.directions)
        return torque
