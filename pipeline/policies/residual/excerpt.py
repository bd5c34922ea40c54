"""Parts of a recording."""

from collections.abc import Collection
from dataclasses import replace

from pipeline.errors import InputError
from pipeline.recordings.recording import Recording


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
