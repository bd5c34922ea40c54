"""Motion of a swerve drive's treads over the ground, as effects add it to rolling: signals by name."""

from simgap.physics.shapes import PerModule, Real, Value, Vector
from simgap.platforms.mechanism import Constants, Signals
from simgap.platforms.swerve_constraint import twist_across

SLIDING = "sliding"
"""How freely each wheel slides, (..., 4): from 0, where it rolls, to 1, where how fast it turns says nothing."""
LEAST_SLIP = "least_slip"
"""How fast the tread of a wheel passes over the ground at least, for it pulls harder than its grip, (..., 4) m/s."""
CREEP_ALONG = "creep_along"
"""How fast the tread of a wheel passes over the ground in proportion to its pull, (..., 4) m/s."""
CREEP_ACROSS = "creep_across"
"""How fast a wheel drifts to its left in proportion to the side force on it, (..., 4) m/s."""
CREEP = 0.05  # m/s; a tread gives way a little wherever it pulls: slower motion over the ground is no sliding


def drift_of(signals: Signals, angle: PerModule, constants: Constants) -> Vector | float:
    """Return the twist of a chassis whose tyres give way to side forces, (..., 3); 0 where none do."""
    across = signals.get(CREEP_ACROSS)
    return 0.0 if across is None else twist_across(across, angle, constants)


def beyond_creep(speed: Real, creep: Value) -> Real:
    """Return what of a speed is beyond creep, both in m/s, or in rad/s of a motor."""
    return speed.sign() * (speed.abs() - creep).clamp_min(0.0)
