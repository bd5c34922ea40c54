"""Steering axes of the modules, with the scrub torque of the tyres."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.joint import effects as joint
from simgap.plants.joint.axis import Axis, bodies
from simgap.plants.joint.friction import Friction, friction_of
from simgap.plants.joint.load import load_of
from simgap.plants.rotation import Array
from simgap.platforms import Swerve

_SIZELESS: dict[str, float] = {}


@dataclass
class Scrub:
    """A tyre's patch that rubs: bristles whose level fades as the wheel rolls.

    Pacejka 2012, "Tire and vehicle dynamics", §9.2; at rest the patch winds up before it slides.

    Attributes:
        level: at rest, N·m.
        patch: radius over which it rubs, m.
        bristles: their law, of which the level is this one's own.
        deflection: (axes,) rad.
    """

    level: float
    patch: float
    bristles: Friction
    deflection: Array

    def torque(self, turning: Array, rolling: Array, step: float) -> Array:
        """Return the torque on each module (axes,), N·m, and let the patch wind up for a step.

        Args:
            turning: of the module, rad/s.
            rolling: of the wheel, m/s.
            step: s.
        """
        rubbing = (self.patch * turning) ** 2 + _STANDSTILL_SPEED**2
        level = np.maximum(self.level * np.sqrt(rubbing / (rubbing + rolling**2)), self.bristles.least)
        self.deflection = self.bristles.bend(self.deflection, turning, level, step)
        return self.bristles.dry_force(self.deflection, turning, level)


_STANDSTILL_SPEED = 1e-4  # m/s, below which a wheel and its patch stand


def steering_of(
    effects: Concealed, outside: Concealed, platform: Swerve, effort: float, start: tuple[Array, Array]
) -> Axis:
    """Return the modules (bodies, axes) at an angle and rate (axes,), one axis per run and module.

    Args:
        effects: all that is concealed of the robot.
        outside: likewise.
        platform: for the modules' inertia.
        effort: typical, N·m.
        start: angle, rad, and rate, rad/s.
    """
    inertia = platform.steer.inertia
    own = _of_a_joint(effects)
    spot = outside.values.get("steering_spot")
    beyond = Concealed({"tight_spot": spot} if spot else {}, joint.OUTSIDE, _SIZELESS)
    shares, coupling = bodies(own, inertia, effort)
    resting = np.zeros_like(start[0])
    position, velocity = (np.tile(series, (len(shares), 1)) for series in start)
    return Axis(
        inertia=inertia * shares,
        coupling=coupling,
        friction=friction_of(own, beyond, inertia, effort),
        load=load_of(_magnet(own, outside), beyond, 0.0, 0.0, inertia),
        age=resting,
        position=position,
        velocity=velocity,
        acceleration=np.zeros_like(position),
        foreseen=velocity,
        bristles=resting,
        strain=resting,
        effort=resting,
        transmitted=resting,
        external=resting,
    )


def scrub_of(effects: Concealed, platform: Swerve, effort: float, axes: int) -> Scrub | None:
    """Return the rubbing of the patches that a case conceals."""
    level = effects.get("scrub_torque@steer", "level")
    if not level:
        return None
    own = Concealed({}, joint.CONCEALABLE, _SIZELESS)
    bristles = friction_of(own, Concealed({}, joint.OUTSIDE, _SIZELESS), platform.steer.inertia, effort)
    return Scrub(level, effects.get("scrub_torque@steer", "patch_radius"), bristles, np.zeros(axes))


def _of_a_joint(effects: Concealed) -> Concealed:
    """Return what acts on the steering, of what a joint may have as well."""
    steer = effects.group("steer").values
    return Concealed(
        {name: values for name, values in steer.items() if name in joint.CONCEALABLE},
        joint.CONCEALABLE,
        _SIZELESS,
    )


def _magnet(own: Concealed, outside: Concealed) -> Concealed:
    """Return the same with the cogging of a steering motor's magnets."""
    magnet = outside.values.get("steering_magnet")
    if magnet is None:
        return own
    cogging = {**magnet, "phase": 0.0, "second_harmonic": 0.0}
    return Concealed({**own.values, "cogging": cogging}, joint.CONCEALABLE, _SIZELESS)
