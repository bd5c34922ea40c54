"""Which three signals are the accelerometer, in which unit, and in which axes."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simgap.logs.common_times import values_at
from simgap.logs.guessing.vectors import Vector, is_estimated
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposed

_WORDS = frozenset(("a", "acc", "accel", "acceleration", "accelerometer", "specific", "force", "linear"))
_GRAVITY = 9.81  # m/s², the contract's
_UNITS = {
    "m/s²": (9.0, 10.6, 1.0),
    "g": (0.92, 1.08, _GRAVITY),
}  # medians of the norm: most of a flight is near hover
_UPRIGHT = 0.8  # of the norm along z, in most of a flight
_CLEARLY = 0.8  # of the error in the other axes
_LAG = 10  # samples over which the velocity changes more than its noise
_MOST = 40_000  # samples that are looked at
_AXES = ("x", "y", "z")


def specific_force(
    log: Log, triples: Sequence[Vector], columns: Mapping[str, Proposed]
) -> tuple[dict[str, Proposed], tuple[str, ...]]:
    """Propose the accelerometer, where velocity and attitude show that it is in the axes of the body.

    Args:
        log: with times in s.
        triples: vectors with three axes.
        columns: what is proposed already: attitude and velocity.

    Returns:
        The columns, and sentences on what was left out.
    """
    for vector in sorted(triples, key=lambda each: (is_estimated(each), len(each.context))):
        parts = [log.signals[name] for name in vector.names]
        if not vector.words & _WORDS or len({len(part.time) for part in parts}) != 1:
            continue
        norm = float(np.nanmedian(np.linalg.norm([part.values for part in parts], axis=0)))
        up = float(np.nanmedian(parts[2].values))
        for unit, (low, high, factor) in _UNITS.items():
            if low < norm < high and abs(up) > _UPRIGHT * norm:
                signs = (1, 1, 1) if up > 0 else (1, -1, -1)
                scaled = np.array(signs)[:, None] * factor * np.stack([part.values for part in parts])
                return _in_axes(log, parts, unit, signs, scaled, columns)
    return {}, ()


def _in_axes(
    log: Log,
    parts: Sequence[Signal],
    unit: str,
    signs: tuple[int, int, int],
    scaled: NDArray[np.float64],
    columns: Mapping[str, Proposed],
) -> tuple[dict[str, Proposed], tuple[str, ...]]:
    named = ", ".join(part.name for part in parts)
    errors = _errors(log, parts[0].time, scaled, columns)
    if errors is None:
        return {}, (
            f"{named} may be the accelerometer; without velocity and attitude its axes are not known.",
        )
    body, world = errors
    if world < _CLEARLY * body:
        return {}, (
            f"{named} is in the axes of the world, and specific_force in those of the body: left out.",
        )
    if body > _CLEARLY * world:
        return {}, (f"{named} may be in the axes of the world or of the body: left out.",)
    why = f"gravity in {unit}, and changes the velocity as an accelerometer of the body does"
    return {
        f"specific_force_{axis}": Proposed(Source(part.name, unit, sign=sign), 0.95, why)
        for axis, part, sign in zip(_AXES, parts, signs, strict=True)
    }, ()


def _errors(
    log: Log, time: NDArray[np.float64], force: NDArray[np.float64], columns: Mapping[str, Proposed]
) -> tuple[float, float] | None:
    """Return by how much the velocity misses the integral of a force in axes of the body, and in those of the world."""
    names = [f"attitude_{axis}" for axis in "wxyz"] + [f"velocity_{axis}" for axis in _AXES]
    if any(name not in columns for name in names):
        return None
    time, force = time[:_MOST], force[:, :_MOST]
    sources = [columns[name].source for name in names]
    values = np.stack([each.sign * values_at(log.signals[each.signal], time, held=False) for each in sources])
    known = np.isfinite(values).all(axis=0) & np.isfinite(force).all(axis=0)
    known &= np.linalg.norm(values[:4], axis=0) > 0.5
    time, values, force = time[known], values[:, known], force[:, known]
    if len(time) <= _LAG:
        return None
    turned = Rotation.from_quat(values[:4].T, scalar_first=True).apply(force.T)
    return _missed(time, turned, values[4:].T), _missed(time, force.T, values[4:].T)


def _missed(time: NDArray[np.float64], force: NDArray[np.float64], velocity: NDArray[np.float64]) -> float:
    steps = np.diff(time)[:, None]
    acceleration = force - np.array([0.0, 0.0, _GRAVITY])
    gained = np.cumsum(0.5 * (acceleration[1:] + acceleration[:-1]) * steps, axis=0)
    errors = (velocity[1 + _LAG :] - velocity[1:-_LAG]) - (gained[_LAG:] - gained[:-_LAG])
    return float(np.median(np.linalg.norm(errors[:, :2], axis=1)))
