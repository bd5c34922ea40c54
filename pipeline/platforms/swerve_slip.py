"""Motion of a swerve drive's treads over the ground, as effects add it to rolling: signals by name."""

from simgap.physics.shapes import PerModule, Real, Value, Vector
from simgap.platforms.mechanism import Constants, Signals
from simgap.platforms.swerve_constraint import twist_across

SLIDING = "sliding"
"""How freely each wheel slides, (..., 4): from 0, where it rolls, to 1, where how fast it turns says nothing."""
SPINNING = "spinning"
"""How much harder each wheel pulls than its grip, (..., 4): 0 where it holds, ±1 where its tread passes over the ground
forward or backward for certain, faster than it gives way."""
CREEP_ALONG = "creep_along"
"""How fast the tread of a wheel passes over the ground in proportion to its pull, (..., 4) m/s."""
CREEP_ACROSS = "creep_across"
"""How fast a wheel drifts to its left in proportion to the side force on it, (..., 4) m/s."""
CREEP = 0.05  # m/s of rolling, below which a tread gives way as much as at this speed; it bounds slip ratios at rest
GIVES_WAY = 0.05
"""Slip ratio up to which a tread that pulls gives way: a tyre has most of its grip by then (Pacejka 2012, §1.2)."""


def drift_of(signals: Signals, angle: PerModule, constants: Constants) -> Vector | float:
    """Return the twist of a chassis whose tyres give way to side forces, (..., 3); 0 where none do."""
    across = signals.get(CREEP_ACROSS)
    return 0.0 if across is None else twist_across(across, angle, constants)


def beyond_creep(speed: Real, creep: Value) -> Real:
    """Return what of a speed is no creep, both in m/s, or in rad/s of a motor: none of a slower one, all of a fast one.

    Source: Breiman 1995, Better subset regression using the nonnegative garrote (Technometrics 37).
    """
    return speed * (1.0 - (creep / speed.abs().clamp_min(1e-12)).square()).clamp_min(0.0)
