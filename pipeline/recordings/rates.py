"""Rates averaged over 0.1 s: as recorded, and derived from the angle or position."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

_HALF_WINDOW = 0.05  # s; long against quantised and held samples, short against a manoeuvre
_SCALAR_LAST = [f"attitude_{axis}" for axis in "xyzw"]


def recorded_and_derived(frame: pd.DataFrame, rate: str, angle: str) -> tuple[np.ndarray, np.ndarray]:
    """Return a rate averaged over windows and the change of a channel over them, shape (windows,).

    Args:
        frame: `run`, `t` and the channels.
        rate: the channel that was recorded as a rate.
        angle: the channel whose rate it is.
    """
    pairs = [
        (_average(run[rate].to_numpy(dtype=float), half), (values[2 * half :] - values[: -2 * half]) / span)
        for run, half, span in _windows(frame)
        for values in (run[angle].to_numpy(dtype=float),)
    ]
    return _joined(pairs)


def body_rate_and_derived(frame: pd.DataFrame, axis: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the body rate about an axis averaged over windows, and the attitude's, shape (windows,).

    Args:
        frame: `run`, `t`, `attitude_*` and `body_rate_*`.
        axis: x, y or z.
    """
    from scipy.spatial.transform import Rotation  # its import takes as long as reading most recordings

    pairs = []
    for run, half, span in _windows(frame):
        attitude = run[_SCALAR_LAST].to_numpy(dtype=float)
        before, after = attitude[: -2 * half], attitude[2 * half :]
        derived = np.full(len(before), np.nan)
        known = np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)
        turned = Rotation.from_quat(before[known]).inv() * Rotation.from_quat(after[known])
        derived[known] = turned.as_rotvec()[:, "xyz".index(axis)] / span[known]
        pairs.append((_average(run[f"body_rate_{axis}"].to_numpy(dtype=float), half), derived))
    return _joined(pairs)


def _windows(frame: pd.DataFrame) -> Iterator[tuple[pd.DataFrame, int, np.ndarray]]:
    """Yield each run that is long enough, half a window in samples, and the time each window spans."""
    for _, run in frame.groupby("run", sort=False):
        time = run["t"].to_numpy(dtype=float)
        half = max(1, round(_HALF_WINDOW / float(np.median(np.diff(time))))) if len(time) > 2 else len(time)
        if len(time) > 4 * half:
            yield run, half, time[2 * half :] - time[: -2 * half]


def _average(values: np.ndarray, half: int) -> np.ndarray:
    return np.convolve(values, np.full(2 * half + 1, 1 / (2 * half + 1)), mode="valid")


def _joined(pairs: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Join the runs, without the windows in which a value is missing."""
    if not pairs:
        return np.empty(0), np.empty(0)
    recorded, derived = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
    known = np.isfinite(recorded) & np.isfinite(derived)
    return recorded[known], derived[known]
