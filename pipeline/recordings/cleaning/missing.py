"""Runs without any value of a required channel."""

from collections.abc import Collection

import numpy as np
import pandas as pd

from simgap.recordings.contract import ANY_OF, required_channels

_FEWEST_SAMPLES = 2  # samples that make a channel
_USABLE = 0.5  # share of samples from which on a group counts as recorded


def lacking(frame: pd.DataFrame, kind: str, groups: Collection[str]) -> str:
    """Return the reason why a run cannot be used; empty if it can.

    Args:
        frame: the run.
        kind: quadrotor, swerve or joint.
        groups: what `needed_groups` tells of it.
    """
    needed = required_channels(kind, frame.columns)
    empty = [column for column in needed if np.count_nonzero(_known(frame, column)) < _FEWEST_SAMPLES]
    if empty:
        return f"no values in {', '.join(empty)}"
    if ANY_OF[kind] and not groups:
        return f"no values in {' nor '.join(group[0] for group in ANY_OF[kind])}"
    return ""


def _known(frame: pd.DataFrame, column: str) -> np.ndarray:
    return ~np.isnan(frame[column].to_numpy(dtype="float64"))


def needed_groups(frame: pd.DataFrame, kind: str) -> list[str]:
    """Return the channels of those any-of groups that a run was recorded with.

    A group that is there for a small part of the run must not cut off the rest, so it counts only when it has
    at least half the samples of the best one.
    """
    shares = {
        group: float(np.mean(np.logical_and.reduce([_known(frame, column) for column in group])))
        for group in ANY_OF[kind]
        if set(group) <= set(frame.columns)
    }
    best = max(shares.values(), default=0.0)
    if best * len(frame) < _FEWEST_SAMPLES:
        return []
    return [column for group, share in shares.items() if share >= _USABLE * best for column in group]


def erase_sparse_groups(
    frame: pd.DataFrame, kind: str, groups: Collection[str]
) -> tuple[pd.DataFrame, dict[str, int]]:
    """Empty the any-of groups that do not count; return the frame and how many values each channel lost.

    Args:
        frame: a run.
        kind: quadrotor, swerve or joint.
        groups: what `needed_groups` tells of it.
    """
    sparse = [
        column for group in ANY_OF[kind] for column in group if column in frame and column not in groups
    ]
    lost = {column: int(np.count_nonzero(_known(frame, column))) for column in sparse}
    return (frame.assign(**dict.fromkeys(sparse, np.nan)) if sparse else frame), lost
