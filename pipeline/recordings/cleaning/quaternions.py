"""Unit quaternions with continuous sign."""

from collections.abc import Sequence

import numpy as np

from simgap.recordings.cleaning.channels import QUATERNIONS
from simgap.recordings.cleaning.work import RunUnderCleaning

_EXACT = 1e-6  # of the norm; float32 telemetry is off by less
_NO_ROTATION = 0.1  # of the norm; an attitude this far off is refused on reading, an estimate is erased here


def mend_quaternions(run: RunUnderCleaning) -> None:
    """Normalise quaternions, give neighbours the same sign (q and −q are one rotation), erase what is no
    rotation."""
    for columns in QUATERNIONS:
        if run.has(columns):
            name = columns[0].removesuffix("_w")
            off = np.abs(run.length(columns) - 1.0)
            run.erase(off > _NO_ROTATION, columns, "quaternions", "norm too far from 1 for a rotation")
            slight = (off > _EXACT) & (off <= _NO_ROTATION)
            _normalise(run, np.flatnonzero(slight), columns)
            detail = f"norm off by up to {off[slight].max():.2g}" if slight.any() else ""
            run.note("quaternions", name, "normalised", int(slight.sum()), detail)
            flipped = np.flatnonzero(_flipped([run.column(column) for column in columns]))
            for place in run.index(columns) if len(flipped) else ():
                run.table.own(place)[flipped] *= -1.0
            run.note("quaternions", name, "sign made continuous", len(flipped))


def _normalise(run: RunUnderCleaning, samples: np.ndarray, columns: list[str]) -> None:
    if not len(samples):
        return
    quaternion = run.rows(samples, columns)
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    for place, component in zip(run.index(columns), quaternion.T, strict=True):
        run.table.own(place)[samples] = component


def _flipped(quaternion: Sequence[np.ndarray]) -> np.ndarray:
    """Return which quaternions must be negated for neighbours to be alike, shape (samples,)."""
    known = np.logical_and.reduce([np.isfinite(component) for component in quaternion])
    present = quaternion if known.all() else [component[known] for component in quaternion]
    cosine = np.zeros(max(len(present[0]) - 1, 0))
    for component in present:
        cosine += component[1:] * component[:-1]
    flipped, turns = np.zeros(len(known), dtype=bool), cosine < 0
    if turns.any():
        other = np.zeros(len(present[0]), dtype=bool)
        other[1:] = np.cumsum(turns) % 2 == 1
        flipped[known] = other
    return flipped


def slerp(start: np.ndarray, end: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Interpolate between two rotations at constant rate.

    Args:
        start: unit quaternions, shape (samples, 4).
        end: unit quaternions, shape (samples, 4).
        share: 0 at `start`, 1 at `end`, shape (samples,).

    Source: Shoemake, "Animating rotation with quaternion curves" (1985).
    """
    cosine = (start * end).sum(axis=1)
    end = np.where((cosine < 0)[:, None], -end, end)
    angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    small = angle < 1e-6  # there a straight line is the same to rounding
    sine = np.where(small, 1.0, np.sin(angle))
    first = np.where(small, 1.0 - share, np.sin((1.0 - share) * angle) / sine)
    second = np.where(small, share, np.sin(share * angle) / sine)
    result = first[:, None] * start + second[:, None] * end
    return result / np.linalg.norm(result, axis=1, keepdims=True)
