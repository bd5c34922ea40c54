"""Zero-phase low-pass filters, which look ahead and cannot run live.

They belong to the protocol of the nanodrone benchmark (arXiv 2512.14450), whose published errors are those of filtered
runs. Filter recordings, the scored ones included, only to compare with such a table.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.signal import butter, sosfiltfilt

from simgap.errors import InputError
from simgap.recordings.recording import Recording

ORDER = 4  # of the Butterworth filter, which runs forwards and backwards


def both_ways(sections: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return a segment (samples, channels) filtered forwards and backwards, so that nothing is shifted in time.

    Its ends are continued as far as the filter remembers, or as far as there are samples.

    Args:
        sections: of the filter, of second order, (sections, 6).
        values: at least one sample.
    """
    padding = min(3 * (2 * len(sections) + 1), len(values) - 1)
    return np.asarray(sosfiltfilt(sections, values, axis=0, padlen=padding))


def zero_phase(recording: Recording, frequencies: Mapping[str, float]) -> Recording:
    """Return the recording with some channels filtered, segment by segment.

    Args:
        recording: cleaned.
        frequencies: by the name of a channel, or what the names of several begin with, the frequency in Hz at which
            each of the two passes halves the power. Quaternions `attitude` are made continuous, and unit length again.

    Raises:
        InputError: when there is no such channel, or the frequency is not between zero and half the sampling rate.
    """
    frame = recording.frame.copy()
    keys = ["run", "segment"] if "segment" in frame else ["run"]
    rows = list(frame.groupby(keys, sort=False).indices.values())
    for name, frequency in frequencies.items():
        columns = _columns(recording, name)
        sections = _sections(name, frequency, recording.time_step)
        values = frame[columns].to_numpy(dtype=np.float64, copy=True)
        for own in rows:
            values[own] = _filtered(values[own], sections, quaternion=name == "attitude")
        frame[columns] = values
    return replace(recording, frame=frame)


def _columns(recording: Recording, name: str) -> list[str]:
    columns = [
        channel for channel in recording.channels if channel.rpartition("_")[0] == name or channel == name
    ]
    if not columns:
        raise InputError("is not a channel of the recording", f"train.zero_phase.{name}", "remove it")
    return columns


def _sections(name: str, frequency: float, time_step: float) -> np.ndarray:
    highest = 0.5 / time_step
    if not 0.0 < frequency < highest:
        raise InputError(
            f"{frequency:g} Hz is not between 0 and half the sampling rate",
            f"train.zero_phase.{name}",
            f"stay below {highest:g} Hz",
        )
    return np.asarray(butter(ORDER, frequency, fs=1.0 / time_step, output="sos"))


def _filtered(values: np.ndarray, sections: np.ndarray, quaternion: bool) -> np.ndarray:
    """Filter one segment (samples, channels)."""
    if quaternion:
        turned = np.sum(values[1:] * values[:-1], axis=1) < 0.0
        values[1:] *= np.where(np.cumsum(turned) % 2, -1.0, 1.0)[:, None]
    smooth = both_ways(sections, values)
    return smooth / np.linalg.norm(smooth, axis=1, keepdims=True) if quaternion else smooth
