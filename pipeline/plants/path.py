"""Reference paths of flights: sums of sines with a varying pace."""

import math
from dataclasses import dataclass, replace

import numpy as np

from simgap.plants.case import PlantCase
from simgap.plants.rotation import Array

MANOEUVRES = ("random", "circle", "eight", "sprint", "climb")

_PACE_DEPTH, _PACE_PERIOD = 0.3, 7.0  # share and s by which the pace along the path swings
_GOLDEN = (5**0.5 - 1) / 2  # spreads speeds evenly over manoeuvres, whatever the number of runs
_BASE_FREQUENCY = 1.4  # rad/s, of a manoeuvre that is not slowed down for its acceleration
_LOWEST_HEIGHT = 1.5  # m above the floor
_LOW_SPEED, _LOW_ACCELERATION = 1.5, 2.5  # m/s and m/s² at most over the floor, so that nobody touches it
_LOW_HEIGHT, _LOW_SPAN = (
    0.12,
    0.2,
)  # m: lowest point of a low path, and how far it goes up and down from its middle
_ON_PURPOSE = {
    "hover": ("hover",),
    "line": ("line",),
}  # flights that leave most unexcited, by their manoeuvres
_VERTICAL_WEIGHT = 2.0  # an acceleration downwards is limited by gravity, and rotors do not push down


@dataclass(frozen=True)
class Paths:
    """Paths of all runs; axes are x, y, z in m and heading in rad, world frame.

    Attributes:
        names: of the runs.
        amplitude: (runs, 4, harmonics).
        frequency: same shape, rad/s.
        phase: same shape, rad.
        turning: steady change of heading, (runs,) rad/s.
        height: about which the path goes up and down, (runs,) m.
    """

    names: tuple[str, ...]
    amplitude: Array
    frequency: Array
    phase: Array
    turning: Array
    height: Array

    def at(self, time: float | Array) -> tuple[Array, Array, Array]:
        """Return position and heading (..., runs, 4) with first and second derivatives at times (...), s."""
        swing = 2.0 * np.pi / _PACE_PERIOD
        angle = swing * np.asarray(time, dtype=float)[..., None, None]
        progress = angle / swing + _PACE_DEPTH / swing * (1.0 - np.cos(angle))
        pace = 1.0 + _PACE_DEPTH * np.sin(angle)
        quickening = _PACE_DEPTH * swing * np.cos(angle)
        argument = self.frequency * progress[..., None] + self.phase
        sine, slope = self.amplitude * np.sin(argument), self.amplitude * self.frequency * np.cos(argument)
        value, first = sine.sum(axis=-1), slope.sum(axis=-1)
        second = -(self.frequency**2 * sine).sum(axis=-1)
        value[..., 2] += self.height
        value[..., 3] += self.turning * progress[..., 0]
        first[..., 3] += self.turning
        return value, first * pace, second * pace**2 + first * quickening


def plan(case: PlantCase, random: np.random.Generator) -> Paths:
    """Return paths on which every manoeuvre is flown and peak speeds range from slowest to fastest."""
    manoeuvres = _ON_PURPOSE.get(case.flown, MANOEUVRES)
    names = [manoeuvres[run % len(manoeuvres)] for run in range(case.runs)]
    order = np.argsort(np.argsort([(run * _GOLDEN) % 1.0 for run in range(case.runs)]))
    shapes = [_shape(name, random) for name in names]
    amplitude, frequency, phase = (np.stack(part) for part in zip(*shapes, strict=True))
    amplitude[:, 2] *= case.flown != "level"
    sense = random.choice([-1.0, 1.0], case.runs)
    paths = Paths(
        names=tuple(f"{name}_{run + 1}" for run, name in enumerate(names)),
        amplitude=amplitude,
        frequency=frequency,
        phase=phase,
        turning=sense * random.uniform(0.15, 0.5, case.runs) * (case.flown not in _ON_PURPOSE),
        height=np.zeros(case.runs),
    )
    speeds = np.linspace(case.slowest, case.fastest, case.runs)[order]
    if case.flown == "hover":
        return replace(paths, height=np.full(case.runs, _LOWEST_HEIGHT))
    if case.flown == "low":
        return _low(_scaled(paths, np.minimum(speeds, _LOW_SPEED), case, _LOW_ACCELERATION), case)
    return _scaled(paths, speeds, case, case.acceleration)


def _low(paths: Paths, case: PlantCase) -> Paths:
    """Bring paths down to the floor: how far up and down they go is cut to what a ground effect reaches."""
    amplitude = paths.amplitude.copy()
    half = np.abs(amplitude[:, 2]).sum(axis=-1)
    amplitude[:, 2] *= np.minimum(1.0, _LOW_SPAN / half)[:, None]
    lowest = max(_LOW_HEIGHT, 4.0 * math.sqrt(case.strength("ground_effect")))
    return replace(paths, amplitude=amplitude, height=lowest + np.minimum(half, _LOW_SPAN))


def _scaled(paths: Paths, speeds: Array, case: PlantCase, limit: float) -> Paths:
    """Scale shapes to peak speeds (runs,), m/s, and slow down those that exceed a limit of acceleration, m/s²."""
    _, velocity, acceleration = paths.at(np.linspace(0.0, case.duration, 500))
    weight = np.array([1.0, 1.0, _VERTICAL_WEIGHT])
    size = speeds / np.linalg.norm(velocity[..., :3], axis=-1).max(axis=0)
    felt = size * np.linalg.norm(weight * acceleration[..., :3], axis=-1).max(axis=0)
    slowing = np.minimum(1.0, limit / felt)[:, None, None]
    amplitude = paths.amplitude.copy()
    amplitude[:, :3] *= size[:, None, None] / slowing
    return replace(
        paths,
        amplitude=amplitude,
        frequency=paths.frequency * slowing,
        height=_LOWEST_HEIGHT + np.abs(amplitude[:, 2]).sum(axis=-1),
    )


def _shape(manoeuvre: str, random: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return amplitude, frequency and phase (4, harmonics) of a manoeuvre, of any size."""
    amplitude, phase = np.zeros((4, 4)), random.uniform(0.0, 2.0 * np.pi, (4, 4))
    frequency = _BASE_FREQUENCY * np.tile([1.0, 2.0, 0.5, 0.3], (4, 1))
    heading = random.uniform(0.0, 2.0 * np.pi)
    along = np.array([np.cos(heading), np.sin(heading), 0.0, 0.0])
    amplitude[2, 2] = 0.15  # some climbing everywhere
    if manoeuvre == "circle":
        amplitude[0, 0] = amplitude[1, 0] = 1.0
        phase[1, 0] = phase[0, 0] + np.pi / 2
    elif manoeuvre == "eight":
        amplitude[0, 0], amplitude[1, 1] = 1.0, 0.5
        phase[1, 1] = 2.0 * phase[0, 0]
    elif manoeuvre == "sprint":
        amplitude[:, 0] = along
        phase[:, 0] = phase[0, 0]
    elif manoeuvre == "line":
        amplitude[:] = 0.0
        amplitude[0, 0] = 1.0
        return amplitude, frequency, phase
    elif manoeuvre == "hover":
        return np.zeros((4, 4)), frequency, phase
    elif manoeuvre == "climb":
        amplitude[:, 3] = 0.6 * along
        amplitude[2, :2] = 0.5, 0.15
    else:
        amplitude[:3] = random.uniform(0.3, 1.0, (3, 4)) * [0.5, 0.15, 1.0, 1.0]
        amplitude[2] *= 0.6
        frequency = frequency * random.uniform(0.85, 1.15, (4, 4))
    amplitude[3, 2] = 0.4  # rad, the nose swings to and fro
    return amplitude, frequency, phase
