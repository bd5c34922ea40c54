"""Signals with times of their own at common times: held, averaged or interpolated, never over a gap."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

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
_BLOCK = 1 << 16  # times that are looked up at once, so that what is between takes little memory
_CYCLE = (
    0.25  # of a step, up to which values count as of one cycle: a program writes them one after the other
)


def base_times(signals: Mapping[str, Signal], kind: str, rate: float | None) -> NDArray[np.float64]:
    """Return the times at which a run is sampled, s of the log's clock, (n,).

    These are the times of the slowest required column that is measured and not held, or uniform ones at `rate`, from
    where all measured columns have begun to where the first ends. Where all are held, as in a log that is written on
    change only, they are the times at which any of the required columns changes.

    Args:
        signals: column to signal, cut to the run.
        kind: of the platform.
        rate: samples per second.
    """
    required = required_channels(kind, signals)
    needed = {name: signal for name, signal in signals.items() if name in required} or signals
    measured = {name: _known(signal) for name, signal in needed.items() if not signal.held}
    bounds = list(measured.values()) or [_known(signal) for signal in needed.values()]
    if any(len(time) < (2 if measured else 1) for time in bounds):
        return np.empty(0)
    begin = max(time[0] for time in bounds)
    end = min(time[-1] for time in bounds) if measured else max(time[-1] for time in bounds)
    if not begin <= end:
        return np.empty(0)
    if rate is not None:
        return np.arange(begin, end, 1.0 / rate)
    slowest = max(measured, key=lambda name: step_of(measured[name]), default="")
    times = signals[slowest].time if measured else _changes(bounds)
    first, past = np.searchsorted(times, begin), np.searchsorted(times, end, side="right")
    return times[first:past]


def _changes(times: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the times at which any of several held signals changes, one for each cycle of what wrote them."""
    union = np.unique(np.concatenate(times))
    apart = np.diff(union) > _CYCLE * min(step_of(time) for time in times)
    return union[np.append(apart, True)]


def in_order(signal: Signal) -> Signal:
    """Return a signal with increasing times; of samples at the same time, the first."""
    if (signal.time[1:] > signal.time[:-1]).all():
        return signal
    _, kept = np.unique(signal.time, return_index=True)
    return replace(signal, time=signal.time[kept], values=signal.values[kept])


def step_of(time: NDArray[np.float64]) -> float:
    """Return the median time between two samples, s; infinite for fewer than two."""
    return float(np.median(np.diff(time), overwrite_input=True)) if len(time) > 1 else np.inf


def values_at(signal: Signal, times: NDArray[np.float64], held: bool) -> NDArray[np.float64]:
    """Return the values of a signal at other times, NaN where it has none.

    Args:
        signal: with increasing times.
        times: (n,), s, increasing.
        held: whether a value holds until the next one.
    """
    if signal.time.shape == times.shape and np.array_equal(signal.time, times) and not held:
        return signal.values
    known = np.isfinite(signal.values)
    time, values = signal.time, signal.values
    if not known.all():
        time, values = time[known], values[known]
    if not len(time):
        return np.full(len(times), np.nan)
    if held:
        return _last(time, values, times)
    place = int(np.searchsorted(time, times[0])) if len(times) else 0
    if np.array_equal(time[place : place + len(times)], times):
        return values[place : place + len(times)]
    step, common = step_of(time), step_of(times)
    found = (
        _averaged(time, values, times, common)
        if step * _AVERAGED < common
        else np.interp(times, time, values)
    )
    found[_in_gaps(time, times, _GAP * max(step, common))] = np.nan
    return found


def commanded_at(signal: Signal, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what a held signal is from each time to the next; where it changes in between, the mean.

    So a command that comes between two samples has the impulse that it had. A change close to a sample counts as of
    that sample: a program writes the values of one cycle one after the other.

    Args:
        signal: with increasing times.
        times: (n,), s, increasing.
    """
    from simgap.recordings.cleaning.filling import mean_of_held

    known = np.isfinite(signal.values)
    time, values = signal.time, signal.values
    if not known.all():
        time, values = time[known], values[known]
    step = step_of(times)
    if not len(time) or not np.isfinite(step):
        return values_at(signal, times, held=True)
    margin = _CYCLE * step
    if np.array_equal(time, times) and _apart(time, step, margin):
        return values
    kept, changes = np.empty(len(times)), np.empty(len(times), dtype=bool)
    for first in range(0, len(times), _BLOCK):
        part = slice(first, first + _BLOCK)
        begun = np.searchsorted(time, times[part] + margin, side="right")
        kept[part] = _before(values, begun)
        changes[part] = np.searchsorted(time, times[part] + step - margin) > begun
    changes &= np.isfinite(kept) & (time[0] <= times)
    if not changes.any():
        return kept
    kept[changes] = mean_of_held(time, values[:, None], times[changes], step)[:, 0]
    return kept


def _apart(time: NDArray[np.float64], step: float, margin: float) -> bool:
    """Whether no time but the next one comes before a step has passed, less a margin."""
    parts = (time[first : first + _BLOCK + 1] for first in range(0, len(time), _BLOCK))
    return all((part[1:] >= part[:-1] + step - margin).all() for part in parts)


def _last(
    time: NDArray[np.float64], values: NDArray[np.float64], times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the last value before or at each time, NaN before the first."""
    return _before(values, np.searchsorted(time, times, side="right"))


def _before(values: NDArray[np.float64], places: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the value before each place, NaN before the first."""
    return np.where(places > 0, values[np.maximum(places - 1, 0)], np.nan)


def _known(signal: Signal) -> NDArray[np.float64]:
    known = np.isfinite(signal.values)
    return signal.time if known.all() else signal.time[known]


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
    if not (np.diff(time) > longest).any():
        return (times < time[0]) | (times > time[-1])
    after = np.searchsorted(time, times, side="left")
    outside = (after == len(time)) | ((after == 0) & (times < time[0]))
    place = np.clip(after, 1, max(len(time) - 1, 1))
    hit = time[np.minimum(after, len(time) - 1)] == times
    wide = (time[np.minimum(place, len(time) - 1)] - time[place - 1] > longest) & ~hit
    return np.asarray(outside | wide)
