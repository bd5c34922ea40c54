"""Quantities that several effects of the quadrotor share."""

from simgap.effects.effect import Signals, Values
from simgap.physics.shapes import Channels, PerModule, Real, Value, Vector
from simgap.platforms.quadrotor_mechanism import rotor_reaction, rotor_thrust

__all__ = [
    "along_axes",
    "hover_rotor_speed",
    "rotor_reaction",
    "rotor_speed_ratio",
    "rotor_thrust",
    "spin_momentum",
]


def rotor_speed_ratio(signals: Signals, constants: Values) -> Real:
    """Mean rotor speed over the rotor speed that carries the weight (...,)."""
    return signals["rotor_speed"].mean(-1) / hover_rotor_speed(constants)


def hover_rotor_speed(constants: Values) -> Value:
    """Rotor speed at which four rotors carry the weight, rad/s."""
    weight = constants["mass"] * constants["gravity"]
    return (weight / (4.0 * constants["thrust_coefficient"])) ** 0.5


def along_axes(stem: str, vector: Vector) -> Channels:
    """Name the three components of a (..., 3) vector as channels."""
    return {f"{stem}_{axis}": vector[..., index] for index, axis in enumerate("xyz")}


def spin_momentum(speed: PerModule, constants: Values) -> Real:
    """Return the rotors' angular momentum about +z relative to the body, over the inertia of one (...,) rad/s.

    The reaction torque of the air on the body is opposite to the rotor's spin, so the spin is −direction. Accelerations
    in place of speeds give the rate of change of that momentum.

    Args:
        speed: of each rotor, never negative, (..., 4) rad/s.
        constants: of the platform.
    """
    return -(constants["rotor_directions"].to(speed) * speed).sum(-1)
