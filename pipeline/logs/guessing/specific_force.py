"""Which three signals are the accelerometer, in which unit, and in which axes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simgap.logs.common_times import values_at
from simgap.logs.guessing.vectors import Vector, is_estimated
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import SURE, Proposed
from simgap.recordings.units import conversion

_WORDS = frozenset(("a", "acc", "accel", "acceleration", "accelerometer", "specific", "force", "linear"))
_GRAVITY = 9.81  # m/s², the contract's
_NORM = (8.0, 18.0)  # m/s², medians: most of a flight is near hover, of a race up to 1.8 g
_UPRIGHT = 0.8  # of the norm along z, in most of a flight
_CLEARLY = 0.8  # of the error in the other axes
_LAG = 10  # samples over which the velocity changes more than its noise
_MOST = 40_000  # samples that are looked at
_NO_ROTATION = 0.5  # norm below which four numbers are no quaternion
_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Measured:
    """What an accelerometer says.

    Attributes:
        columns: proposed columns; empty where there is none in the axes of the body.
        notes: sentences on what was left out.
        down: whether velocity and attitude are in a frame whose z points down: north, east, down; forward, right, down.
    """

    columns: Mapping[str, Proposed]
    notes: tuple[str, ...] = ()
    down: bool = False


def specific_force(log: Log, triples: Sequence[Vector], columns: Mapping[str, Proposed]) -> Measured:
    """Propose the accelerometer, where velocity and attitude show in which axes it is.

    Args:
        log: with times in s.
        triples: vectors with three axes.
        columns: what is proposed already: attitude and velocity.
    """
    for vector in sorted(triples, key=lambda each: (is_estimated(each), len(each.context))):
        parts = [log.signals[name] for name in vector.names]
        if not vector.words & _WORDS or len({len(part.time) for part in parts}) != 1:
            continue
        values = np.stack([part.values for part in parts])
        norm, up = float(np.nanmedian(np.linalg.norm(values, axis=0))), float(np.nanmedian(values[2]))
        for unit, factor in _units(parts[0].unit):
            if _NORM[0] < factor * norm < _NORM[1] and abs(up) > _UPRIGHT * norm:
                return _in_axes(log, parts, unit, factor * values, columns)
    return Measured({})


def _units(declared: str | None) -> list[tuple[str, float]]:
    """Return the units that an accelerometer may be in, with their factors to m/s²; the declared one first."""
    names = [declared] if declared else []
    found = {unit: conversion(unit) for unit in [*names, "m/s²", "g", "mg"]}
    return [(unit, known[1]) for unit, known in found.items() if known and known[0] == "m/s²"]


def _in_axes(
    log: Log,
    parts: Sequence[Signal],
    unit: str,
    force: NDArray[np.float64],
    columns: Mapping[str, Proposed],
) -> Measured:
    named = ", ".join(part.name for part in parts)
    errors = _errors(log, parts[0].time, force, columns)
    if errors is None:
        return Measured(
            {}, (f"{named} may be the accelerometer: without velocity and attitude nobody knows its axes.",)
        )
    best = min(errors, key=lambda axes: errors[axes])
    if any(errors[best] > _CLEARLY * error for axes, error in errors.items() if axes != best):
        return Measured({}, (f"{named} may be in the axes of the world or of the body: left out.",))
    if best == "world":
        note = f"{named} is in the axes of the world, and specific_force in those of the body: left out."
        return Measured({}, (note,))
    signs = (1, -1, -1) if best in ("down", "flipped") else (1, 1, 1)
    why = f"gravity in {unit}, and changes the velocity as an accelerometer of the body does"
    why += "; its z points down" if best in ("down", "flipped") else ""
    declared = parts[0].unit
    sure = 0.95 if declared is None or conversion(declared) == conversion(unit) else 0.7
    why += f", but {declared} is said" if sure < SURE else ""
    found = {
        f"specific_force_{axis}": Proposed(Source(part.name, unit, sign=sign), sure, why)
        for axis, part, sign in zip(_AXES, parts, signs, strict=True)
    }
    return Measured(found, down=best == "down")


def _errors(
    log: Log, time: NDArray[np.float64], force: NDArray[np.float64], columns: Mapping[str, Proposed]
) -> dict[str, float] | None:
    """Return by how much the velocity misses the integral of a force, by the axes that it is taken to have.

    These are body and world as in the contract; `flipped`, of a sensor with y and z turned; `down`, where all frames
    have z down.
    """
    names = [f"attitude_{axis}" for axis in "wxyz"] + [f"velocity_{axis}" for axis in _AXES]
    if any(name not in columns for name in names):
        return None
    time, force = time[:_MOST], force[:, :_MOST]
    sources = [columns[name].source for name in names]
    values = np.stack([each.sign * values_at(log.signals[each.signal], time, held=False) for each in sources])
    known = np.isfinite(values).all(axis=0) & np.isfinite(force).all(axis=0)
    known &= np.linalg.norm(values[:4], axis=0) > _NO_ROTATION
    time, values, force = time[known], values[:, known], force[:, known]
    if len(time) <= _LAG + 1:
        return None
    attitude, velocity = Rotation.from_quat(values[:4].T, scalar_first=True), values[4:].T
    up, turned_over = np.array([0.0, 0.0, _GRAVITY]), force.T * (1.0, -1.0, -1.0)
    return {
        "body": _missed(time, attitude.apply(force.T) - up, velocity),
        "world": _missed(time, force.T - up, velocity),
        "flipped": _missed(time, attitude.apply(turned_over) - up, velocity),
        "down": _missed(time, attitude.apply(force.T) + up, velocity),
    }


def _missed(
    time: NDArray[np.float64], acceleration: NDArray[np.float64], velocity: NDArray[np.float64]
) -> float:
    steps = np.diff(time)[:, None]
    gained = np.cumsum(0.5 * (acceleration[1:] + acceleration[:-1]) * steps, axis=0)
    errors = (velocity[1 + _LAG :] - velocity[1:-_LAG]) - (gained[_LAG:] - gained[:-_LAG])
    return float(np.median(np.linalg.norm(errors, axis=1)))
