"""Unit quaternions without jumps of sign."""

import numpy as np

from pipeline.recordings.cleaning.channels import QUATERNIONS
from pipeline.recordings.cleaning.work import RunUnderCleaning

_EXACT = 1e-6  # float32 telemetry is off by this much


def mend_quaternions(run: RunUnderCleaning) -> None:
    """Normalise quaternions and give neighbours the same sign (q and −q are one rotation)."""
    for columns in QUATERNIONS:
        if run.has(columns):
            places = run.index(columns)
            quaternion, off, flipped = _mend(run.values[:, places])
            run.values[:, places] = quaternion
            detail = f"norm off by up to {np.nanmax(off):.2g}" if np.isfinite(off).any() else ""
            name = columns[0].removesuffix("_w")
            run.note("quaternions", name, "normalised", int((off > _EXACT).sum()), detail)
            run.note("quaternions", name, "sign made continuous", int(flipped.sum()))


def _mend(quaternion: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the quaternions, by how much their norm was off, and which were negated."""
    norm = np.linalg.norm(quaternion, axis=1)
    off = np.abs(norm - 1.0)
    result = np.where((off > _EXACT)[:, None], quaternion / norm[:, None], quaternion)
    known = np.flatnonzero(np.isfinite(norm))
    jump = (result[known[1:]] * result[known[:-1]]).sum(axis=1) < 0
    negated = np.zeros(len(result), dtype=bool)
    negated[known[1:]] = np.cumsum(jump) % 2 == 1
    result[negated] *= -1.0
    return result, off, negated


def slerp(start: np.ndarray, end: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Turn steadily from one rotation to another.

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
