"""Excerpts of a recording, and evenly spaced samples."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.recordings.recording import Recording


def evenly(total: int, most: int) -> NDArray[np.int64]:
    """Return evenly spaced indices, at most as many as wanted, both ends included."""
    return np.unique(np.linspace(0, total - 1, min(most, total)).round().astype(np.int64))


def of_runs(recording: Recording, names: Collection[str]) -> Recording:
    """Return some runs of a recording."""
    frame = recording.frame[recording.frame["run"].isin(names)]
    return replace(recording, frame=frame.reset_index(drop=True))


def first_seconds(recording: Recording, seconds: float | None) -> Recording:
    """Return so many seconds of a cleaned recording, run after run from the first; all of it where none are named.

    Raises:
        InputError: when no sample is left.
    """
    if seconds is None:
        return recording
    samples = round(seconds / recording.time_step)
    if samples < 1:
        raise InputError(f"{seconds} s hold no sample", "residual.seconds", "give more")
    frame = recording.frame.iloc[:samples]
    return replace(recording, frame=frame.reset_index(drop=True))
