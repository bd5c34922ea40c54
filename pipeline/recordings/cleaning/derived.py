"""Channels that are derived from another one where nobody recorded them.

The derivative is that of a quartic through five samples, which is Fornberg's difference of fourth order; at the ends of
a stretch it is the same polynomial's. A longer or lower polynomial would average noise away, and fast motion with it.
The equations of motion stand under smooth windows, which average noise themselves.
Source: Savitzky & Golay 1964 (Anal. Chem. 36); Fornberg 1988 (Math. Comput. 51), table 1.
"""

import itertools

import numpy as np
import pandas as pd
from scipy.signal import savgol_filter

from simgap.recordings.contract import DERIVED_FROM, channel_units
from simgap.recordings.runs import stretches_of_runs

_SAMPLES, _ORDER = 5, 4


def with_derived(
    frame: pd.DataFrame, kind: str, units: dict[str, str], time_step: float
) -> tuple[pd.DataFrame, dict[str, str], tuple[str, ...]]:
    """Return a cleaned frame with the channels that it lacks and another one shows.

    Args:
        frame: uniform in time inside each (run, segment).
        kind: quadrotor, swerve or joint.
        units: of the channels.
        time_step: s.

    Returns:
        The frame, with its channels in the order of the contract, their units, and the names of those derived.
    """
    lacking = {rate: of for rate, of in DERIVED_FROM.get(kind, {}).items() if rate not in frame}
    if not lacking:
        return frame, units, ()
    parts = _segments(frame)
    derived = {
        rate: np.concatenate([derivative(values[part], time_step) for part in parts])
        for rate, values in ((rate, frame[of].to_numpy(dtype="float64")) for rate, of in lacking.items())
    }
    known = channel_units(kind, units.get("position") == "m")
    order = [column for column in known if column in units or column in derived]
    index = [column for column in frame.columns if column not in units]
    columns = {name: derived[name] if name in derived else frame[name] for name in (*index, *order)}
    whole = pd.DataFrame(columns, copy=False)
    return whole, {column: known[column] for column in order}, tuple(derived)


def _segments(frame: pd.DataFrame) -> list[slice]:
    """Return the rows of each segment of each run, which are neighbours."""
    _, runs = stretches_of_runs(frame["run"])
    edges = np.union1d(runs, 1 + np.flatnonzero(np.diff(frame["segment"].to_numpy())))
    return [slice(begin, end) for begin, end in itertools.pairwise(edges.tolist())]


def derivative(series: np.ndarray, time_step: float) -> np.ndarray:
    """Return the time derivative of a series (samples,), even in time."""
    if len(series) < 2:
        return np.zeros_like(series)
    if len(series) < _SAMPLES:
        return np.asarray(np.gradient(series, time_step))
    return np.asarray(savgol_filter(series, _SAMPLES, _ORDER, deriv=1, delta=time_step))


def derived_remark(channels: tuple[str, ...], kind: str) -> str:
    """Return a sentence about channels that were derived."""
    return " ".join(
        f"No {name} was recorded; it is the slope of a quartic through five samples of the "
        f"{DERIVED_FROM[kind][name]}."
        for name in channels
    )
