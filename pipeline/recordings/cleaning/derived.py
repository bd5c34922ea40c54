"""Channels that are derived from another one where nobody recorded them.

The derivative is that of a quartic through five samples, which is Fornberg's difference of fourth order; at the ends of
a stretch it is the same polynomial's. A longer or lower polynomial would average noise away, and fast motion with it.
The equations of motion stand under smooth windows, which average noise themselves.
Source: Savitzky & Golay 1964 (Anal. Chem. 36); Fornberg 1988 (Math. Comput. 51), table 1.
"""

import numpy as np
import pandas as pd
from scipy.signal import savgol_filter

from simgap.recordings.contract import DERIVED_FROM, channel_units

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
    groups = frame.groupby(["run", "segment"], sort=False)
    derived = {
        rate: groups[of].transform(lambda part: derivative(part.to_numpy(dtype="float64"), time_step))
        for rate, of in lacking.items()
    }
    known = channel_units(kind, units.get("position") == "m")
    order = [column for column in known if column in units or column in derived]
    whole = frame.assign(**derived)
    index = [column for column in frame.columns if column not in units]
    return whole[[*index, *order]], {column: known[column] for column in order}, tuple(derived)


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
