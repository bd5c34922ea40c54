"""The pulses to the motors at the rate of the rate controller.

ArduPilot writes RCOU ten times a second, too slowly to see a motor follow; but what its rate controller gives the mixer
(RATE.ROut, POut, YOut, AOut: roll, pitch, yaw and throttle) is written at up to the rate of its loop. The mixer is
linear but for its limits and the curve of thrust (AP_MotorsMatrix), so each output is fitted on these four in the log
itself. How well that holds is checked by who uses it, on the samples that were not fitted.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal
from simgap.logs.records import Records, RecordSignals

PREFIX = "RATE.RCOU."
_OUTPUTS = ("ROut", "POut", "YOut", "AOut")
_IDLE = 0.05  # of the range of an output above its least: below that a motor is off or idles, which no mixer decides
_FEWEST = 25  # samples, five for each coefficient
_ROUNDS = 3
_FAR = 3.0  # standard deviations, as far as a sample may lie from the fit: more is a limit of the mixer


def pulses(
    fields: Mapping[str, tuple[Records, str]],
) -> Iterator[tuple[str, Callable[[], Signal]]]:
    """Yield names as RATE.RCOU.C1, and what computes their signals.

    Args:
        fields: name of a signal to its records and its field in them.
    """
    if not all(f"RATE.{output}" in fields for output in _OUTPUTS):
        return
    signals = RecordSignals(fields)
    for name in fields:
        if name.startswith("RCOU.C"):
            yield PREFIX + name.removeprefix("RCOU."), partial(_pulse, signals, name)


def _pulse(signals: RecordSignals, name: str) -> Signal:
    """Return one output at the times of RATE, µs; NaN where it cannot be fitted."""
    told, rate = signals[name], [signals[f"RATE.{output}"] for output in _OUTPUTS]
    fitted = Signal(name, told.time[::2], told.values[::2])
    at = np.stack([nearest(output, fitted.time) for output in rate] + [np.ones(len(fitted.time))], 1)
    weights = _fit(at, fitted.values)
    whole = np.stack([output.values for output in rate] + [np.ones(len(rate[0].values))], 1)
    return Signal(PREFIX + name.removeprefix("RCOU."), rate[0].time, whole @ weights, None, held=True)


def nearest(signal: Signal, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the value next to each time: RATE and RCOU of one turn of the loop are milliseconds apart.

    Args:
        signal: with increasing times.
        times: (n,), s.
    """
    if not len(signal.time):
        return np.full(len(times), np.nan)
    after = np.clip(np.searchsorted(signal.time, times), 1, max(len(signal.time) - 1, 1))
    after = np.minimum(after, len(signal.time) - 1)
    before = np.maximum(after - 1, 0)
    closer = times - signal.time[before] < signal.time[after] - times
    return np.where(closer, signal.values[before], signal.values[after])


def agreement(told: Signal, computed: Signal, within: NDArray[np.bool_]) -> float:
    """Return R² of the computed pulses on the samples that were not fitted; −inf where there are too few.

    Args:
        told: RCOU.
        computed: the same output of RATE.
        within: which samples of `told` count, (n,).
    """
    counted = within.copy()
    counted[::2] = False
    values, found = told.values[counted], nearest(computed, told.time[counted])
    if len(values) < _FEWEST or not np.isfinite(found).all() or not np.ptp(values):
        return -np.inf
    return float(1.0 - np.mean((values - found) ** 2) / np.var(values))


def _fit(given: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the coefficients of least squares, without idle motors and what the mixer limits."""
    known = np.isfinite(given).all(axis=1)
    kept = known & (values > values.min() + _IDLE * np.ptp(values)) if len(values) else known
    weights = np.full(given.shape[1], np.nan)
    for _ in range(_ROUNDS):
        if np.count_nonzero(kept) < _FEWEST:
            break
        weights = np.linalg.lstsq(given[kept], values[kept], rcond=None)[0]
        error = np.where(known, values - given @ weights, np.inf)
        kept = kept & (np.abs(error) <= _FAR * np.std(error[kept]))
    return weights
