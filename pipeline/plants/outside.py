"""Physics outside the catalogue. Wind gusts, outside it as well, are in `wind`."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from simgap.plants.airframe import Airframe
from simgap.plants.case import PlantCase
from simgap.plants.integration import AdamsBashforth
from simgap.plants.rotation import Array
from simgap.plants.wind import first_order_noise

_FLUTTER_TIME = 0.15  # s, in which the wake of a rotor in its own vortex ring forgets itself
_FLUTTER_SHARE = 0.5  # standard deviation over mean of the thrust lost there
_SLIDING_TIME = 0.15  # s
_SLIDING_TILT = 0.3  # of the vertical's in-plane part, at which a loose weight has gone most of its way
_HEATING_TIME = 6.0  # s
_ARM_DAMPING = 0.06  # over critical, of a carbon arm in its clamp


@dataclass(frozen=True)
class Moment:
    """Present state of the machine for a disturbance; body frame, (runs, ...) each.

    Attributes:
        index: of the step.
        rotation: body to world.
        velocity: through the air, m/s.
        rotor_speed: rad/s.
    """

    index: int
    rotation: Array
    velocity: Array
    rotor_speed: Array


Disturbance = Callable[[Moment, Array, Array], tuple[Array, Array]]
"""From specific force, m/s², and torque, N·m, without it to those with it; both (runs, 3), body frame."""


class VortexRing:
    """Thrust lost, and fluttering, where rotors descend into their own wake.

    Leishman 2006, §2.13.6: worst at a descent at the hover's induced velocity, and blown away by cross-flow.
    """

    def __init__(self, depth: float, airframe: Airframe, flutter: Array) -> None:
        """Take the share of thrust lost at worst, and noise of unit variance (steps, runs)."""
        self.depth, self.rotor, self.flutter = depth, airframe.rotor, flutter

    def __call__(self, now: Moment, force: Array, torque: Array) -> tuple[Array, Array]:
        """Return the wrench with it."""
        induced = self.rotor.still_inflow(now.rotor_speed.mean(axis=-1))[0]
        descent = -now.velocity[:, 2] / induced
        crossing = (now.velocity[:, :2] ** 2).sum(axis=-1) / induced**2
        inside = np.exp(-(((descent - 1.0) / 0.5) ** 2) - crossing)
        lost = self.depth * inside * (1.0 + _FLUTTER_SHARE * self.flutter[now.index])
        return force * (1.0 - lost[:, None] * np.array([0.0, 0.0, 1.0])), torque


class ShiftingMass:
    """A weight that hangs loose, follows the vertical, and takes the centre of mass with it."""

    def __init__(self, travel: float, airframe: Airframe, step: float) -> None:
        """Take how far the centre of mass moves at most, m, and the step, s."""
        self.travel, self.mass = travel, airframe.mass
        self.follow = 1.0 - math.exp(-step / _SLIDING_TIME)
        self.place: Array | None = None

    def __call__(self, now: Moment, force: Array, torque: Array) -> tuple[Array, Array]:
        """Return the wrench with it."""
        wanted = self.travel * np.tanh(-now.rotation[:, 2, :2] / _SLIDING_TILT)
        before = wanted if self.place is None else self.place
        self.place = before + self.follow * (wanted - before)
        along, left = self.place[:, 0], self.place[:, 1]
        x, y, z = (self.mass * force[:, axis] for axis in range(3))
        return force, torque - np.stack((left * z, -along * z, along * y - left * x), axis=-1)


class ThrustFade:
    """Motors that lose thrust as they heat up."""

    def __init__(self, depth: float, hover: float, step: float) -> None:
        """Take the share of thrust lost when hot from hovering at a rotor speed, rad/s, and the step, s."""
        self.depth, self.hover = depth, hover
        self.follow = 1.0 - math.exp(-step / _HEATING_TIME)
        self.heat: Array | float = 0.0

    def __call__(self, now: Moment, force: Array, torque: Array) -> tuple[Array, Array]:
        """Return the wrench with it."""
        power = ((now.rotor_speed / self.hover) ** 3).mean(axis=-1, keepdims=True)
        self.heat = self.heat + self.follow * (power - self.heat)
        left = 1.0 - self.depth * np.tanh(self.heat)
        return force * left, torque * left


class HeadingTorque:
    """A yaw torque that goes with the sine of the heading, as of a magnet in a field."""

    def __init__(self, amplitude: float) -> None:
        """Take the greatest torque, N·m."""
        self.amplitude = amplitude

    def __call__(self, now: Moment, force: Array, torque: Array) -> tuple[Array, Array]:
        """Return the wrench with it."""
        east, north = now.rotation[:, 0, 0], now.rotation[:, 1, 0]
        sine = north / np.sqrt(east * east + north * north)
        return force, torque + self.amplitude * sine[:, None] * np.array([0.0, 0.0, 1.0])


class ArmResonance:
    """Arms that swing: a share of the torque reaches the body through a lightly damped mode."""

    def __init__(self, share: float, frequency: float, step: float) -> None:
        """Take the share of the torque, the mode's frequency, Hz, and the step, s."""
        self.share, self.pulsation = share, 2.0 * math.pi * frequency
        self.advance = AdamsBashforth(step)
        self.state: Array | None = None

    def __call__(self, now: Moment, force: Array, torque: Array) -> tuple[Array, Array]:
        """Return the wrench with it."""
        state = np.stack((torque, np.zeros_like(torque))) if self.state is None else self.state
        bent, bending = state
        quickening = self.pulsation**2 * (torque - bent) - 2.0 * _ARM_DAMPING * self.pulsation * bending
        self.state = self.advance(state, np.stack((bending, quickening)))
        return force, torque + self.share * (bent - torque)


def disturbances(
    case: PlantCase, airframe: Airframe, hover: float, steps: int, step: float, random: np.random.Generator
) -> list[Disturbance]:
    """Return what disturbs the plant beyond the catalogue.

    Args:
        case: which, and how strongly.
        airframe: the plant.
        hover: rotor speed, rad/s.
        steps: of the flight.
        step: s.
        random: for what flutters.
    """
    present = case.unnamed
    built: list[Disturbance] = []
    if "vortex_ring" in present:
        flutter = first_order_noise((steps, case.runs), step / _FLUTTER_TIME, random)
        built.append(VortexRing(**present["vortex_ring"], airframe=airframe, flutter=flutter))
    if "shifting_mass" in present:
        built.append(ShiftingMass(**present["shifting_mass"], airframe=airframe, step=step))
    if "thrust_fade" in present:
        built.append(ThrustFade(**present["thrust_fade"], hover=hover, step=step))
    if "heading_torque" in present:
        built.append(HeadingTorque(**present["heading_torque"]))
    if "arm_resonance" in present:
        built.append(ArmResonance(**present["arm_resonance"], step=step))
    return built


SHOWS_IN: dict[str, dict[str, Any]] = {
    "gusts": {"channel": "force_x", "depends_on": []},
    "vortex_ring": {"channel": "force_z", "depends_on": ["velocity_z", "velocity_x", "velocity_y"]},
    "shifting_mass": {"channel": "torque_y", "depends_on": ["attitude"]},
    "thrust_fade": {"channel": "force_z", "depends_on": ["elapsed", "rotor_speed"]},
    "heading_torque": {"channel": "torque_z", "depends_on": ["attitude"]},
    "arm_resonance": {"channel": "torque_x", "depends_on": ["rotor_speed"]},
}
"""Where each shows most, and the variables that it goes with; gusts go with nothing that is recorded."""
