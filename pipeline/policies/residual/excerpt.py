"""The beginning of a recording."""

from dataclasses import replace

from pipeline.errors import InputError
from pipeline.recordings.recording import Recording


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
