"""Equivalent parameters: projection of the true forces of a flight on the catalogue's laws."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simgap.plants.airframe import Airframe
from simgap.plants.drive import sag_exponent, speed_at_voltage
from simgap.plants.flight import Log
from simgap.plants.rotation import Array, cross, matrix
from simgap.platforms import Quadrotor

_UP = np.array([0.0, 0.0, 1.0])
_ACROSS, _ALONG = np.array([1.0, 1.0, 0.0]), _UP  # the rotors' axis, body frame


@dataclass(frozen=True)
class Flown:
    """A flight's states (samples, runs, ...), thinned out.

    Attributes:
        rotation: body to world.
        velocity: over ground, body frame, m/s.
        airspeed: through the air, body frame, m/s.
        body_rate: rad/s.
        rotor_speed: rad/s.
        height: of the centre of mass over the floor, m.
        spin: mean rotor speed over that of hover, (samples, runs, 1).
        lift: thrust of the nominal law with the true coefficient and mass, (samples, runs, 1) m/s².
    """

    rotation: Array
    velocity: Array
    airspeed: Array
    body_rate: Array
    rotor_speed: Array
    height: Array
    spin: Array
    lift: Array


def lumped(name: str, airframe: Airframe, platform: Quadrotor, log: Log) -> float:
    """Return the coefficient with which a law of `LAWS` comes nearest to what an effect truly adds in still air.

    Args:
        name: of the effect.
        airframe: the plant with the effect.
        platform: for the hover rotor speed, by which laws are scaled.
        log: the flights.
    """
    flown = _flown(airframe, platform, log)
    acts_on, law = LAWS[name]
    added = _steady_wrench(airframe, flown, flown.velocity)[acts_on]
    added = added - _steady_wrench(airframe.without(name), flown, flown.velocity)[acts_on]
    shape = law(flown)
    return float((shape * added).sum() / (shape * shape).sum())


def lumped_in_wind(
    names: list[str], airframe: Airframe, platform: Quadrotor, log: Log
) -> dict[str, dict[str, float]]:
    """Return the parameters with which the laws of forces in the air come nearest to those in a wind.

    The push of the wind is what it does to a machine that stands still over ground.

    Args:
        names: of the concealed effects that have a law; those that twist are left alone.
        airframe: the plant with its effects.
        platform: for the hover rotor speed.
        log: the flights, with their wind.
    """
    flown = _flown(airframe, platform, log)
    forces = [name for name in names if LAWS[name][0] == _FORCE]
    bare = airframe
    for name in forces:
        bare = bare.without(name)

    def added(velocity: Array) -> Array:
        return (
            _steady_wrench(airframe, flown, velocity)[_FORCE] - _steady_wrench(bare, flown, velocity)[_FORCE]
        )

    in_air = replace(flown, velocity=flown.airspeed)
    found = _projected(added(flown.airspeed), [LAWS[name][1](in_air) for name in forces])
    # Across the rotors' axis and along it a wind pushes by different drags: each part has a size of its own.
    parts = [part * flown.rotation[..., axis, :] for part in (_ACROSS, _ALONG) for axis in range(2)]
    push_x, push_y, *_ = _projected(added(flown.airspeed - flown.velocity), parts)
    named = {name: {"coefficient": value} for name, value in zip(forces, found, strict=True)}
    return named | {"steady_wind": {"push_x": push_x, "push_y": push_y}}


def _projected(force: Array, laws: Sequence[Array]) -> list[float]:
    """Return the coefficients with which laws come nearest to a force."""
    design = np.stack([np.ravel(law) for law in laws], axis=-1)
    return [float(value) for value in np.linalg.lstsq(design, np.ravel(force), rcond=None)[0]]


def lumped_sag(strength: float, platform: Quadrotor, log: Log) -> float:
    """Return the sensitivity with which a linear law comes nearest to rotor speeds at the voltages of the flights.

    Args:
        strength: with which the motors feel the voltage.
        platform: nominal voltage and hover rotor speed.
        log: the flights, with their voltage.
    """
    assert log.voltage is not None, "the motors have felt the voltage"
    flown = _thinned(log)
    command, ratio = log.rotor_command[flown], log.voltage[flown][..., None] / platform.nominal_voltage
    felt = ratio ** sag_exponent(strength)
    added = speed_at_voltage(command, felt, platform.hover_rotor_speed) - command
    law = command * (ratio - 1.0)
    return float((law * added).sum() / (law * law).sum())


def _thinned(log: Log) -> slice:
    return slice(round(log.before / log.step), None, max(round(0.01 / log.step), 1))


def _flown(airframe: Airframe, platform: Quadrotor, log: Log) -> Flown:
    thin = _thinned(log)
    rotation = matrix(log.attitude[thin])
    wind = np.zeros(3) if log.wind is None else log.wind[thin]
    velocity, airspeed = (
        (world[..., None, :] @ rotation)[..., 0, :]
        for world in (log.velocity[thin], log.velocity[thin] - wind)
    )
    speed = log.rotor_speed[thin]
    squares = airframe.rotor.thrust_coefficient * (speed * speed).sum(axis=-1, keepdims=True)
    return Flown(
        rotation=rotation,
        velocity=velocity,
        airspeed=airspeed,
        body_rate=log.body_rate[thin],
        rotor_speed=speed,
        height=log.position[thin][..., 2],
        spin=speed.mean(axis=-1, keepdims=True) / platform.hover_rotor_speed,
        lift=squares / airframe.mass,
    )


def _steady_wrench(airframe: Airframe, flown: Flown, velocity: Array) -> tuple[Array, Array]:
    return airframe.settled(velocity, flown.body_rate, flown.rotor_speed, flown.height)


def _rotor_drag(flown: Flown) -> Array:
    return -flown.spin * flown.velocity * (1.0 - _UP)


def _axial_inflow(flown: Flown) -> Array:
    return -flown.spin * flown.velocity * _UP


def _translational_lift(flown: Flown) -> Array:
    return (flown.velocity[..., :2] ** 2).sum(axis=-1, keepdims=True) * _UP


def _body_drag(flown: Flown) -> Array:
    return -np.linalg.norm(flown.velocity, axis=-1, keepdims=True) * flown.velocity


def _ground_effect(flown: Flown) -> Array:
    return flown.lift / flown.height[..., None] ** 2 * _UP


def _blade_flapping_moment(flown: Flown) -> Array:
    return -flown.spin * cross(np.broadcast_to(_UP, flown.velocity.shape), flown.velocity)


def _angular_drag(flown: Flown) -> Array:
    return -flown.body_rate


_FORCE, _TORQUE = 0, 1

LAWS: dict[str, tuple[int, Callable[[Flown], Array]]] = {
    "rotor_drag": (_FORCE, _rotor_drag),
    "axial_inflow": (_FORCE, _axial_inflow),
    "translational_lift": (_FORCE, _translational_lift),
    "body_drag": (_FORCE, _body_drag),
    "ground_effect": (_FORCE, _ground_effect),
    "blade_flapping_moment": (_TORQUE, _blade_flapping_moment),
    "angular_drag": (_TORQUE, _angular_drag),
}
"""Specific force, m/s², or torque, N·m, per unit of coefficient."""
