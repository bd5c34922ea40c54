"""Runs that are the two directions of one test, such as a ramp forward and the same ramp backward.

By signals, two runs are opposite if one is the mirror image of the other: some channels of its motion, or its commands,
change their sign, and the others stay as they are. By names they are opposite if the names differ by the word or sign
of the direction alone. Either is enough: signals know of names that mean nothing, and names of tests that end early.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

_MODULES = range(1, 5)
_COMMANDS = {
    "joint": ("effort", "voltage", "position_command"),
    "swerve": tuple(f"{group}_voltage_{module}" for group in ("drive", "steer") for module in _MODULES),
    "quadrotor": (),  # in a mirrored flight the rotors change places, and no command changes its sign
}
_MOTIONS = {
    "joint": ("velocity",),
    "swerve": (
        *("chassis_velocity_x", "chassis_velocity_y", "chassis_rate"),
        *(f"{group}_velocity_{module}" for group in ("drive", "steer") for module in _MODULES),
    ),
    "quadrotor": tuple(f"{motion}_{axis}" for motion in ("velocity", "body_rate") for axis in "xyz"),
}
_POINTS = 256  # of the time grid on the longest run: 20 ms on a test of 5 s
# What follows is set by hand on the published recordings of conf/dataset and on a servo bench (HSM150): the two
# directions of a test are 0.00 to 0.25 apart, a test in the other direction at another strength 0.35 and more.
_MIRRORED = 1 / 3  # of the signals' size, up to which two runs are mirror images
_ACTIVE = 0.1  # of a run's energy, from which on a channel takes part
_TURNED = 0.25  # of the size of all channels, from which on those that change their sign make a direction
_AWAKE = 0.05  # of a run's mean energy; it begins and ends where it has as much
_SMOOTH = 0.05  # of a run, over which its energy is averaged for that: single samples of noise have more
_OVERLAP = 0.5  # of the longer run, which the shorter one has to last at least
_SHIFT = 0.2  # of the shorter run, by which one may begin earlier: a slow beginning hides in noise
_MOST_RUNS = 150  # whose signals are compared with each other: 3 s; of more runs only names are
_FAR = np.inf
_DIRECTIONS = (
    ("forward", "backward"),
    ("forward", "reverse"),
    ("forwards", "backwards"),
    ("fwd", "bwd"),
    ("fwd", "rev"),
    ("fw", "bw"),
    ("clockwise", "counterclockwise"),
    ("clockwise", "anticlockwise"),
    ("cw", "ccw"),
    ("positive", "negative"),
    ("pos", "neg"),
    ("plus", "minus"),
    ("up", "down"),
)
_PLUS, _MINUS = re.compile(r"\+(?=\.?\d)"), re.compile(r"(?<![a-z0-9])-(?=\.?\d)")


@dataclass(frozen=True)
class _Profile:
    """Commands and motion of a run from its first to its last activity, each channel over its RMS in the recording.

    Attributes:
        command: (points, channels).
        motion: (points, channels).
    """

    command: NDArray[np.float64]
    motion: NDArray[np.float64]


def opposite_runs(frame: pd.DataFrame, kind: str) -> list[tuple[str, str]]:
    """Return the pairs of runs that are the two directions of one test; no run is in two of them.

    Of several partners a run gets the one that its name asks for, else the one that mirrors it best.

    Args:
        frame: of a recording, uniform in time; channels that are incomplete do not count.
        kind: quadrotor, swerve or joint.
    """
    runs = [str(run) for run in frame["run"].unique()]
    named = dict.fromkeys(named_opposites(runs), _FAR)
    apart = named | (_signalled(frame, kind) if 1 < len(runs) <= _MOST_RUNS else {})
    pairs: list[tuple[str, str]] = []
    for one, other in sorted(apart, key=lambda pair: (pair not in named, apart[pair], pair)):
        if not any({one, other} & {*pair} for pair in pairs):
            pairs.append((one, other))
    return pairs


def _signalled(frame: pd.DataFrame, kind: str) -> dict[tuple[str, str], float]:
    """Return the pairs of runs whose signals mirror each other, with how far they are from doing so."""
    profiles = _profiles(frame, kind)
    apart = {
        (one, other): _apart(profiles[one], profiles[other])
        for one, other in combinations(sorted(profiles), 2)
    }
    return {pair: distance for pair, distance in apart.items() if distance <= _MIRRORED}


def named_opposites(runs: Sequence[str]) -> set[tuple[str, str]]:
    """Return the pairs of names, each in alphabetical order, that differ by their direction alone.

    That is a word of `_DIRECTIONS` in place of its opposite, or a minus sign before a number in place of a plus sign
    or none.
    """
    plain = {_plain(run): run for run in sorted(runs, reverse=True)}
    pairs = set()
    for name, run in plain.items():
        for turned in _turned(name):
            if turned != name and turned in plain:
                one, other = sorted((run, plain[turned]))
                pairs.add((one, other))
    return pairs


def _plain(name: str) -> str:
    """Return a name in small letters, with its words apart: `slowForward` becomes slow_forward."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def _turned(name: str) -> list[str]:
    """Return a name with its direction turned round, in every way that the name allows."""
    words = [re.sub(rf"(?<![a-z]){one}(?![a-z])", other, name) for one, other in _DIRECTIONS]
    return [*words, _PLUS.sub("-", name), _MINUS.sub("", name)]


def _profiles(frame: pd.DataFrame, kind: str) -> dict[str, _Profile]:
    """Return the profile of every run, by its name in alphabetical order."""
    complete = [name for name in (*_COMMANDS[kind], *_MOTIONS[kind]) if _is_complete(frame, name)]
    commands = sum(name in _COMMANDS[kind] for name in complete)
    values = frame[complete].to_numpy(dtype="float64")
    size = np.sqrt(np.square(values).mean(0))
    values = values / np.where(size > 0, size, 1.0)
    time = frame["t"].to_numpy(dtype="float64")
    places = frame.groupby(frame["run"].astype(str), sort=True).indices
    cut = {str(run): _awake(time[place], values[place]) for run, place in places.items()}
    step = max(times[-1] for times, _ in cut.values()) / _POINTS
    profiles = {}
    for run, (times, channels) in cut.items():
        grid = np.arange(0.0, times[-1] + 0.5 * step, step) if step > 0 else times[:1]
        on_grid = np.array([np.interp(grid, times, channel) for channel in channels.T]).reshape(
            len(complete), len(grid)
        )
        profiles[run] = _Profile(on_grid[:commands].T, on_grid[commands:].T)
    return profiles


def _is_complete(frame: pd.DataFrame, name: str) -> bool:
    return name in frame and bool(np.isfinite(frame[name]).all())


def _awake(
    time: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut a run to where something happens; its time begins with 0 then."""
    width = int(_SMOOTH * len(values)) + 1
    energy = np.convolve(np.square(values).sum(1), np.full(width, 1.0 / width), "same")
    awake = np.flatnonzero(energy >= _AWAKE * energy.mean())
    within = slice(awake[0], awake[-1] + 1)
    return time[within] - time[awake[0]], values[within]


def _apart(one: _Profile, other: _Profile) -> float:
    """Return how far two runs are from mirror images, over their size; infinite where they are no two directions.

    A test is set by its commands, or by its motion where a controller makes that. Commands count if the motion goes
    against that of the other run, too. A run that repeats another one is none of two directions: a sine is its own
    mirror image half a period later.
    """
    shorter, longer = sorted((len(one.motion), len(other.motion)))
    if shorter < _OVERLAP * longer:
        return _FAR
    most = int(_SHIFT * shorter)
    motion = _compared(one.motion, other.motion, most)
    command = _compared(one.command, other.command, most)
    if np.sqrt(motion.repeated.min()) <= _MIRRORED:
        return _FAR
    by_command = np.where(motion.against, command.mirrored, _FAR)
    return float(np.sqrt(np.minimum(motion.mirrored, by_command).min()))


@dataclass(frozen=True)
class _Compared:
    """Channels of two runs compared at several shifts in time.

    Attributes:
        mirrored: squared distance from mirror images over the squared size, infinite where no direction is turned.
        repeated: squared distance from repetitions, likewise.
        against: whether the channels go against each other.
    """

    mirrored: NDArray[np.float64]
    repeated: NDArray[np.float64]
    against: NDArray[np.bool_]


def _compared(one: NDArray[np.float64], other: NDArray[np.float64], most: int) -> _Compared:
    """Compare channels (points, channels) of two runs where both last, one up to `most` points later or earlier."""
    late = np.arange(-most, most + 1)
    mine = _energy(one, np.maximum(-late, 0), np.minimum(len(one), len(other) - late))
    its = _energy(other, np.maximum(late, 0), np.minimum(len(other), len(one) + late))
    middle = len(one) - 1
    product = np.zeros(mine.shape)
    for channel in range(one.shape[1]):
        whole = np.correlate(other[:, channel], one[:, channel], "full")
        product[:, channel] = whole[middle - most : middle + most + 1]
    active = np.zeros(mine.shape, dtype=bool)
    for energy in (mine, its):
        active |= energy >= _ACTIVE * energy.sum(1, keepdims=True)
    size = np.where(active, np.sqrt(mine * its), 0.0)
    total = size.sum(1)
    turned = np.where(product < 0, size, 0.0).sum(1) > _TURNED * total
    energies = np.where(active, mine + its, 0.0).sum(1)
    products = np.where(active, product, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        mirrored = np.where(turned, (energies - 2.0 * np.abs(products).sum(1)) / total, _FAR)
        repeated = np.where(total > 0, (energies - 2.0 * products.sum(1)) / total, _FAR)
    return _Compared(mirrored.clip(0.0), repeated.clip(0.0), products.sum(1) < 0)


def _energy(
    channels: NDArray[np.float64], start: NDArray[np.int64], end: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the energy of channels (points, channels) between points, (shifts, channels)."""
    whole = np.concatenate([np.zeros((1, channels.shape[1])), np.square(channels).cumsum(0)])
    return whole[end] - whole[start]
