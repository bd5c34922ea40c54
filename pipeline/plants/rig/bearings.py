"""Gravity and friction torques of a gimbal on its body."""

import numpy as np

from simgap.plants.rig.case import Gimbal
from simgap.plants.rotation import Array, cross


class Bearings:
    """The torque of gravity and friction about the point that stays where it is; call it once a step.

    Friction builds up with the angle turned since the last reversal (Dahl 1968, "A solid friction model", of first
    order): d bend/dt = ω − |ω|·bend/give, torque = −friction·bend/give.
    """

    def __init__(self, gimbal: Gimbal, weight: float, runs: int, step: float) -> None:
        """Hold machines of that weight, N; the step is in s."""
        self.gimbal, self.step = gimbal, step
        self.bend = np.zeros((runs, 3))
        self.lever = weight * np.array([gimbal.sideways, 0.0, -gimbal.hanging])  # N·m

    def __call__(self, rotation: Array, body_rate: Array) -> Array:
        """Return the torque (runs, 3), N·m, body frame.

        Args:
            rotation: body to world (runs, 3, 3).
            body_rate: (runs, 3) rad/s.
        """
        gimbal, speed = self.gimbal, np.abs(body_rate)
        limit = gimbal.give * np.sign(body_rate)
        self.bend = limit + (self.bend - limit) * np.exp(-speed * self.step / gimbal.give)
        down = -rotation[:, 2, :]  # in the body frame
        friction = gimbal.friction / gimbal.give * self.bend + gimbal.damping * body_rate
        return cross(self.lever, down) - friction


def inertia_with(gimbal: Gimbal, moments: Array) -> Array:
    """Return the inertia (3, 3), kg·m², of a body with these moments (3,) and the rings that turn with it."""
    inertia = np.diag(moments + np.array(gimbal.rings))
    inertia[0, 2] = inertia[2, 0] = gimbal.skew * np.sqrt(inertia[0, 0] * inertia[2, 2])
    return inertia
