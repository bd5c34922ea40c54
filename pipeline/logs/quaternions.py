"""Attitudes without jumps of sign, since between q and −q, which are the same attitude, nothing can be interpolated."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from simgap.logs.log import Signal

_GROUPS = tuple(tuple(f"{prefix}attitude_{part}" for part in "wxyz") for prefix in ("", "estimate_"))


def without_jumps(columns: Mapping[str, Signal]) -> dict[str, Signal]:
    """Return the columns; where four are an attitude on one clock, each is next to the one before.

    Args:
        columns: column to signal.
    """
    changed = dict(columns)
    for group in _GROUPS:
        if not set(group) <= set(columns):
            continue
        parts = [columns[name] for name in group]
        if any(not np.array_equal(part.time, parts[0].time) for part in parts[1:]):
            continue
        opposite = np.asarray(sum(part.values[1:] * part.values[:-1] for part in parts)) < 0
        if opposite.any():
            signs = np.cumprod(np.concatenate([[1.0], np.where(opposite, -1.0, 1.0)]))
            changed |= {
                name: replace(part, values=part.values * signs)
                for name, part in zip(group, parts, strict=True)
            }
    return changed
