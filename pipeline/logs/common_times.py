"""Signals with times of their own at common times: held, averaged or interpolated, never over a gap."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal
from simgap.recordings.contract import required_channels

_GAP = (
    5.0  # steps of a signal or of the common times; longer gaps stay open, and cleaning counts their samples
)
_AVERAGED = (
    2.0  # times the common rate; of faster signals, linear interpolation would alias what lies between
)


def base_times(signals: Mapping[str, Signal], kind: str, rate: float | None) -> NDArray[np.float64]:
    """Return the times at which a run is sampled, s of the log's clock, (n,).

    These are the times of the slowest required column that is measured and not held, or uniform ones at `rate`, from
    where all measured columns have begun to where the first ends.

    Args:
        signals: column to signal, cut to the run.
        kind: of the platform.
        rate: samples per second.
    """
    measured = {name: _known(signal) for name, signal in signals.items() if not signal.held} or {
        name: _known(signal) for name, signal in signals.items()
    }
    required = required_channels(kind, signals)
    needed = {name: time for name, time in measured.items() if name in required} or measured
    if any(len(time) < 2 for time in needed.values()):
        return np.empty(0)
    begin = max(time[0] for time in needed.values())
    end = min(time[-1] for time in needed.values())
    if rate is not None:
        return np.arange(begin, end, 1.0 / rate)
    slowest = max(needed, key=lambda name: step_of(needed[name]))
    times = signals[slowest].time
    return times[(times >= begin) & (times <= end)]


def step_of(time: NDArray[np.float64]) -> float:
    """Return the median time between two samples, s; infinite for fewer than two."""
    return float(np.median(np.diff(time))) if len(time) > 1 else np.inf


def values_at(signal: Signal, times: NDArray[np.float64], held: bool) -> NDArray[np.float64]:
    """Return the values of a signal at other times, NaN where it has none.

    Args:
        signal: with increasing times.
        times: (n,), s, increasing.
        held: whether a value holds until the next one.
    """
    if signal.time.shape == times.shape and np.array_equal(signal.time, times) and not held:
        return signal.values.copy()
    known = np.isfinite(signal.values)
    time, values = signal.time[known], signal.values[known]
    if not len(time):
        return np.full(len(times), np.nan)
    if held:
        place = np.searchsorted(time, times, side="right") - 1
        return np.where(place >= 0, values[np.maximum(place, 0)], np.nan)
    step, common = step_of(time), step_of(times)
    found = (
        _averaged(time, values, times, common)
        if step * _AVERAGED < common
        else np.interp(times, time, values)
    )
    found[_in_gaps(time, times, _GAP * max(step, common))] = np.nan
    return found


def _known(signal: Signal) -> NDArray[np.float64]:
    return signal.time[np.isfinite(signal.values)]


def _averaged(
    time: NDArray[np.float64], values: NDArray[np.float64], times: NDArray[np.float64], width: float
) -> NDArray[np.float64]:
    """Return means of the linear interpolant over a window around each time."""
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time))])
    low = np.clip(times - width / 2, time[0], time[-1])
    high = np.clip(times + width / 2, time[0], time[-1])
    span = high - low
    area = _antiderivative(high, time, values, integral) - _antiderivative(low, time, values, integral)
    return np.where(span > 0, area / np.where(span > 0, span, 1.0), np.interp(times, time, values))


def _antiderivative(
    at: NDArray[np.float64],
    time: NDArray[np.float64],
    values: NDArray[np.float64],
    integral: NDArray[np.float64],
) -> NDArray[np.float64]:
    place = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    ahead = at - time[place]
    slope = (values[place + 1] - values[place]) / (time[place + 1] - time[place])
    return np.asarray(integral[place] + values[place] * ahead + 0.5 * slope * ahead**2)


def _in_gaps(time: NDArray[np.float64], times: NDArray[np.float64], longest: float) -> NDArray[np.bool_]:
    """Whether each time lies outside the signal, or between two samples that are further apart than `longest`."""
    after = np.searchsorted(time, times, side="left")
    outside = (after == len(time)) | ((after == 0) & (times < time[0]))
    place = np.clip(after, 1, max(len(time) - 1, 1))
    wide = (time[np.minimum(place, len(time) - 1)] - time[place - 1] > longest) & ~np.isin(times, time)
    return np.asarray(outside | wide)
