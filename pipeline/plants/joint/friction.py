"""True friction of a joint (LuGre model).

Canudas de Wit, Olsson, Åström & Lischinsky 1995, "A new model for control of systems with friction" (LuGre); the
damping of the bristles fades as they slide: Olsson 1996, "Control systems with friction", §3.6. The level of friction
depends on speed (Stribeck), direction, load, place and time.
"""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.rotation import Array

BRISTLE_FREQUENCY = 300.0  # rad/s at which the inertia swings on its bristles while it sticks
_BRISTLE_DAMPING_RATIO = 0.2
_LEAST_LEVEL = 1e-9  # of the typical effort: where no bristle holds


@dataclass(frozen=True)
class Friction:
    """The friction of one axis.

    Attributes:
        coulomb: N·m or N.
        extra: by which friction at standstill exceeds `coulomb`.
        stribeck_velocity: rad/s or m/s.
        viscous: N·m·s/rad.
        quadratic: N·m·s²/rad².
        difference: by which the level is greater in the direction of its sign, N·m.
        load_share: of the transmitted effort that is added to the level.
        spot: level, place and width of a tight spot.
        wear: growth of the level, N·m/s.
        stiffness: of the bristles, N·m/rad.
        damping: of the bristles, N·m·s/rad.
        least: level below which nothing is held.
        frequency: of the inertia on the bristles, rad/s.
    """

    coulomb: float
    extra: float
    stribeck_velocity: float
    viscous: float
    quadratic: float
    difference: float
    load_share: float
    spot: tuple[float, float, float]
    wear: float
    stiffness: float
    damping: float
    least: float
    frequency: float

    @property
    def dry(self) -> bool:
        """Whether anything holds at standstill."""
        parts = (self.coulomb, self.extra, self.difference, self.load_share, self.spot[0], self.wear)
        return any(part != 0 for part in parts)

    @property
    def speed_dependent(self) -> bool:
        """Whether friction grows with speed."""
        return self.viscous != 0 or self.quadratic != 0

    def level(self, velocity: Array, position: Array, load: Array, age: Array) -> Array:
        """Return the level at which the bristles slide, N·m or N.

        Args:
            velocity: rad/s or m/s.
            position: rad or m.
            load: transmitted effort, N·m or N.
            age: for how long the machine has run, s.
        """
        level = self.coulomb + self.wear * age
        if self.extra:
            level = level + self.extra * np.exp(-((velocity / self.stribeck_velocity) ** 2))
        if self.difference:
            level = level + np.maximum(self.difference * np.sign(velocity), 0.0)
        if self.load_share:
            level = level + self.load_share * np.abs(load)
        if self.spot[0]:
            level = level + self.spot[0] * np.exp(-(((position - self.spot[1]) / self.spot[2]) ** 2))
        return np.maximum(level, self.least)

    def bend(self, deflection: Array, velocity: Array, level: Array, step: float) -> Array:
        """Return the deflection of the bristles a step later, exact for a held velocity."""
        rate = self.stiffness * np.abs(velocity) / level
        decay = np.exp(-rate * step)
        settled = np.sign(velocity) * level / self.stiffness
        return settled + (deflection - settled) * decay

    def dry_force(self, deflection: Array, velocity: Array, level: Array) -> Array:
        """Return what the bristles do to the axis, N·m or N."""
        slipping = velocity - self.stiffness * np.abs(velocity) / level * deflection
        sliding = 2.0 * self.frequency * level / self.stiffness
        damping = self.damping * np.exp(-((velocity / sliding) ** 2))
        return -self.stiffness * deflection - damping * slipping

    def speed_force(self, velocity: Array) -> Array:
        """Return the friction that grows with speed, N·m or N."""
        return -(self.viscous + self.quadratic * np.abs(velocity)) * velocity


def friction_of(
    effects: Concealed,
    outside: Concealed,
    inertia: float,
    effort: float,
    frequency: float = BRISTLE_FREQUENCY,
) -> Friction:
    """Return the friction that a case conceals.

    Args:
        effects: of the catalogue.
        outside: of none.
        inertia: of the axis, kg·m² or kg.
        effort: typical, N·m or N.
        frequency: of the inertia on the bristles, rad/s.
    """
    spot = tuple(outside.get("tight_spot", key) for key in ("level", "place", "width"))
    stiffness = inertia * frequency**2
    return Friction(
        coulomb=effects.get("coulomb_friction", "level"),
        extra=effects.get("stribeck_friction", "extra_level"),
        stribeck_velocity=effects.get("stribeck_friction", "velocity"),
        viscous=effects.get("viscous_friction", "coefficient"),
        quadratic=effects.get("quadratic_friction", "coefficient"),
        difference=effects.get("asymmetric_friction", "difference"),
        load_share=effects.get("load_dependent_friction", "ratio"),
        spot=(spot[0], spot[1], spot[2]),
        wear=outside.get("wear", "growth"),
        stiffness=stiffness,
        damping=2.0 * _BRISTLE_DAMPING_RATIO * inertia * frequency,
        least=_LEAST_LEVEL * effort,
        frequency=frequency,
    )
