"""Loads on a joint: springs, weights, magnets and a hard stop."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.rotation import Array

_STOP_FREQUENCY = 500.0  # rad/s, of the inertia on the stop's spring
_STOP_DAMPING_RATIO = 0.3


@dataclass(frozen=True)
class Load:
    """Forces that depend on the place, and the hysteresis of an elastic part.

    Attributes:
        gravity: torque of a weight per sine and per cosine of the position, N·m.
        stiffness: N·m/rad.
        cubic: N·m/rad³.
        constant: N·m, forward.
        cogging: amplitude N·m, cycles 1/rad, phase rad, share of the second harmonic.
        ripple: amplitude N·m·s/rad and cycles 1/rad of a force by speed and place.
        hysteresis: level N·m and position of yield rad; 0: none.
        stop: position of a hard stop on either side, and its stiffness and damping.
    """

    gravity: tuple[float, float]
    stiffness: float
    cubic: float
    constant: float
    cogging: tuple[float, float, float, float]
    ripple: tuple[float, float]
    hysteresis: tuple[float, float]
    stop: tuple[float, float, float]

    def force(self, position: Array, velocity: Array, strain: Array) -> Array:
        """Return the effort on the axis, N·m or N.

        Args:
            position: rad or m.
            velocity: rad/s or m/s.
            strain: of the hysteretic part over that at which it yields.
        """
        force = -(self.stiffness + self.cubic * position * position) * position + self.constant
        if self.gravity[0]:
            force = force - self.gravity[0] * np.sin(position)
        if self.gravity[1]:
            force = force - self.gravity[1] * np.cos(position)
        amplitude, cycles, phase, second = self.cogging
        if amplitude:
            angle = cycles * position + phase
            force = force - amplitude * (np.sin(angle) + second * np.sin(2.0 * angle))
        if self.ripple[0]:
            force = force - self.ripple[0] * velocity * np.sin(self.ripple[1] * position)
        if self.hysteresis[0]:
            force = force - self.hysteresis[0] * strain
        place, stiffness, damping = self.stop
        if np.isfinite(place):
            beyond = position - np.clip(position, -place, place)
            push = stiffness * beyond + damping * velocity
            force = force - np.where(push * beyond > 0, push, 0.0)
        return force


def load_of(effects: Concealed, outside: Concealed, gravity: float, stiffness: float, inertia: float) -> Load:
    """Return the load of an axis whose nominal weight and spring the person knows."""
    stop = outside.get("hard_stop", "position")
    return Load(
        gravity=(gravity + effects.get("gravity_load", "sine"), effects.get("gravity_load", "cosine")),
        stiffness=stiffness + effects.get("linear_stiffness", "stiffness"),
        cubic=effects.get("cubic_stiffness", "stiffness"),
        constant=effects.get("constant_load", "load"),
        cogging=(
            effects.get("cogging", "amplitude"),
            effects.get("cogging", "cycles"),
            effects.get("cogging", "phase"),
            effects.get("cogging", "second_harmonic"),
        ),
        ripple=(outside.get("speed_ripple", "amplitude"), outside.get("speed_ripple", "cycles")),
        hysteresis=(effects.get("hysteresis", "level"), effects.get("hysteresis", "displacement")),
        stop=(
            stop if "hard_stop" in outside else np.inf,
            inertia * _STOP_FREQUENCY**2,
            2.0 * _STOP_DAMPING_RATIO * inertia * _STOP_FREQUENCY,
        ),
    )
