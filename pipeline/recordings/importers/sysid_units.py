"""What the numbers of a SysId file are: rotations, as SysId means it, or already the units that the file names.

One rotation gives `unitsPerRotation` units, so a wrong reading is wrong by that factor. Position and velocity tell
whether both are of one sort: one is the other's rate of change. That a machine could not be so fast or so slow at 12 V
rules readings out. What remains is for a person to say.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError

SORTS = ("rotations", "units")
UNITS = {
    "Meters": ("m", 1.0),
    "Feet": ("m", 0.3048),
    "Inches": ("m", 0.0254),
    "Radians": ("rad", 1.0),
    "Degrees": ("rad", math.pi / 180),
    "Rotations": ("rad", 2 * math.pi),
}
"""Units that SysId knows: the contract's unit, and the factor to it."""

_SAME = 0.01  # share by which two readings may differ and still be one: tyres wear by more
_LIKE = 0.15  # of the rate of change: SysId filters velocities, which then lag behind by some 0.1 s
_SUPPLY = 12.0  # V
_SPEEDS = {"m": (0.1, 15.0), "rad": (0.1, 3900.0)}
# At 12 V, m/s and rad/s, wide on purpose. The fastest motor of the FRC turns at 18730 rpm (VEX, 775pro); a gear that
# doubles this gives 3900 rad/s. Robots drive at up to 7 m/s; twice that is ruled out. An axis that needs a minute for a
# turn, or a second for a hand's breadth, is ruled out, too.


@dataclass(frozen=True)
class Samples:
    """One run in the file's numbers.

    Attributes:
        time: s, (n,).
        voltage: V, (n,).
        position: (n,).
        velocity: (n,).
    """

    time: NDArray[np.float64]
    voltage: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]


@dataclass(frozen=True)
class Reading:
    """A reading of the file's numbers.

    Attributes:
        position: `rotations` or `units`.
        velocity: `rotations` or `units`.
        speed: of the machine at 12 V by this reading, m/s or rad/s; None where it did not move.
    """

    position: str
    velocity: str
    speed: float | None


def scale_of(sort: str, factor: float, per_rotation: float) -> float:
    """Return what a number of a sort is in the contract's unit.

    Args:
        sort: `rotations` or `units`.
        factor: of the file's units, as in `UNITS`.
        per_rotation: units of one rotation.
    """
    return factor * per_rotation if sort == "rotations" else factor


def readings_of(runs: Sequence[Samples], units: str, per_rotation: float, where: str) -> list[Reading]:
    """Return the readings of a file that its numbers allow, the likeliest first; one where they say it.

    Args:
        runs: of the file.
        units: as the file names them.
        per_rotation: units of one rotation.
        where: the file, for an error.

    Raises:
        InputError: when no reading makes the velocity the position's rate of change.
    """
    unit, factor = UNITS[units]
    ratio = _rate_ratio(runs)
    pairs = [(position, velocity) for position in SORTS for velocity in SORTS]
    fitting = [pair for pair in pairs if ratio is None or _fits(ratio, pair, per_rotation)]
    if not fitting:
        raise InputError(
            f"the position changes by {ratio:.3g} of what the velocity says", where, "no unit explains that"
        )
    if abs(per_rotation - 1.0) < _SAME:
        fitting = [("units", "units")]
    speed = _speed_at_supply(runs)
    low, high = _SPEEDS[unit]
    found = [
        Reading(
            position,
            velocity,
            None if speed is None else speed * scale_of(velocity, factor, per_rotation),
        )
        for position, velocity in fitting
    ]
    return [each for each in found if each.speed is None or low <= each.speed <= high] or found


def described(readings: Sequence[Reading], units: str) -> str:
    """Return what distinguishes readings, as half a sentence."""
    unit = "m/s" if UNITS[units][0] == "m" else "rad/s"
    return " or ".join(
        f"{_named(each, units)}" + ("" if each.speed is None else f" ({each.speed:.2g} {unit} at 12 V)")
        for each in readings
    )


def _named(reading: Reading, units: str) -> str:
    names = {"rotations": "rotations", "units": units.lower()}
    if reading.position == reading.velocity:
        return names[reading.position]
    return f"positions in {names[reading.position]} and velocities in {names[reading.velocity]}"


def _fits(ratio: float, pair: tuple[str, str], per_rotation: float) -> bool:
    position, velocity = (scale_of(sort, 1.0, per_rotation) for sort in pair)
    return abs(math.log(ratio * position / velocity)) < math.log(1.0 + _LIKE)


def _rate_ratio(runs: Sequence[Samples]) -> float | None:
    """Return the position's change over that by the velocity; None where nothing moves."""
    product = square = 0.0
    for run in runs:
        steps = 0.5 * np.diff(run.time) * (run.velocity[1:] + run.velocity[:-1])
        travelled = np.concatenate([[0.0], np.cumsum(steps)])
        travelled = travelled - travelled.mean()
        product += float(travelled @ (run.position - run.position.mean()))
        square += float(travelled @ travelled)
    return product / square if square > 0 and product > 0 else None


def _speed_at_supply(runs: Sequence[Samples]) -> float | None:
    """Return the velocity at 12 V, in the file's numbers, by V = kV·v + kA·dv/dt.

    Friction is left out: a step of voltage alone does not tell it from the other two, and the order of size is enough.
    """
    parts, targets, moved = [], [], 0
    for run in runs:
        if len(run.time) < 3:
            continue
        moving = np.abs(run.velocity) > 0.1 * np.abs(run.velocity).max()
        moved += int(moving.sum())
        rate = np.gradient(run.velocity, run.time)
        usable = moving & np.isfinite(run.velocity) & np.isfinite(rate) & np.isfinite(run.voltage)
        parts.append(np.stack([run.velocity[usable], rate[usable]]))
        targets.append(run.voltage[usable])
    if moved < 3:
        return None
    table, target = np.concatenate(parts, axis=1).T, np.concatenate(targets)
    constants = np.linalg.lstsq(table, target, rcond=None)[0]
    return float(_SUPPLY / constants[0]) if constants[0] > 0 else None
