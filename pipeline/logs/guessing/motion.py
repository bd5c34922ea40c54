"""What signals say of each other: which is the derivative of which, and whether anything moves."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simgap.logs.common_times import values_at
from simgap.logs.log import Signal

_BLOCKS, _BLOCK = (
    8,
    4000,
)  # stretches of samples that are looked at, and their length: enough for 1 % of a slope
_LAGS = (
    1,
    3,
    10,
    30,
    100,
)  # samples over which differences are taken: short ones are noise, long ones leave none
_PAUSE = 20.0  # median steps; no difference is taken over a longer one
_OUTLIER = 6.0  # times the median deviation: wraps, and sensors that drop out
_FEWEST = 30  # differences that make a slope
_STILL = 0.5  # von Neumann's ratio of 2 is noise alone; at 0.5 noise is a quarter of the variance
_SMALLEST = 1.5e-3  # rad: one count of a 12-bit encoder, the commonest kind
_WRAPPED = 0.98  # of the range that a wrap jumps over


@dataclass(frozen=True)
class Slope:
    """How the change of one signal follows the integral of another.

    Attributes:
        factor: change over integral.
        correlation: from −1 to 1.
    """

    factor: float
    correlation: float


def slope_of(position: Signal, velocity: Signal) -> Slope | None:
    """Return how the change of a position follows the integral of a velocity over time; None where nothing changes.

    Differences over several lags are tried, and the clearest is taken. Jumps are left out.

    Args:
        position: with times in s.
        velocity: with times in s, perhaps others.
    """
    best: Slope | None = None
    pieces = [_piece(position, velocity, part) for part in _parts(len(position.time))]
    for lag in _LAGS:
        changes = np.concatenate([_difference(values, stretch, lag) for values, _, stretch in pieces])
        integrals = np.concatenate([_difference(areas, stretch, lag) for _, areas, stretch in pieces])
        found = _fit(changes, integrals)
        if found is not None and (best is None or abs(found.correlation) > abs(best.correlation)):
            best = found
    return best


def moves(signal: Signal) -> bool:
    """Whether a signal changes by more than its noise, by von Neumann's ratio of differences to variance."""
    values = signal.values[np.isfinite(signal.values)]
    if len(values) < _FEWEST or np.ptp(values) == 0.0:
        return False
    variance = float(np.var(values))
    return bool(np.mean(np.square(np.diff(values))) < _STILL * variance)


def turns(velocity: Signal) -> bool:
    """Whether a velocity is that of something that moves: it changes, or its mean is more than its noise."""
    values = velocity.values[np.isfinite(velocity.values)]
    return moves(velocity) or (len(values) > 0 and abs(float(values.mean())) > float(values.std()))


def range_of(signal: Signal) -> float:
    """Return the range of a signal without its outermost thousandths, in its own unit."""
    values = signal.values[np.isfinite(signal.values)]
    if not len(values):
        return 0.0
    low, high = np.quantile(values, [0.001, 0.999])
    return float(high - low)


def is_still(signal: Signal, factor: float) -> bool:
    """Whether a position does not move: within its noise, or less than a count of a usual encoder.

    Args:
        signal: the position.
        factor: of its unit to rad or m.
    """
    return not moves(signal) or range_of(signal) * abs(factor) < _SMALLEST


def wrap_of(signal: Signal) -> float | None:
    """Return the width over which a signal wraps, a power of two above 255 or a turn; None where it does not.

    A wrap is a step over nearly that width.
    """
    values = signal.values[np.isfinite(signal.values)]
    if len(values) < 2:
        return None
    steps = np.abs(np.diff(values))
    largest = float(steps.max())
    widths = (2 * np.pi, 360.0, *(float(2**bits) for bits in (8, 10, 12, 14, 16, 32)))
    for width in widths:
        if _WRAPPED * width < largest <= width * 1.001 and float(np.median(steps)) < 0.05 * width:
            return width
    return None


def _parts(count: int) -> list[slice]:
    if count <= _BLOCKS * _BLOCK:
        return [slice(0, count)]
    starts = np.linspace(0, count - _BLOCK, _BLOCKS).astype(int)
    return [slice(start, start + _BLOCK) for start in starts]


def _piece(
    position: Signal, velocity: Signal, part: slice
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Return position, integral of velocity, and the number of the unbroken stretch, at the position's times."""
    time = position.time[part]
    inside = (velocity.time >= time[0] - 1.0) & (velocity.time <= time[-1] + 1.0) if len(time) else slice(0)
    near = Signal(velocity.name, velocity.time[inside], velocity.values[inside], held=velocity.held)
    rate = values_at(near, time, held=velocity.held)
    values = position.values[part]
    known = np.isfinite(values) & np.isfinite(rate)
    time, values, rate = time[known], values[known], rate[known]
    if len(time) < 2:
        return np.empty(0), np.empty(0), np.empty(0, dtype=np.int64)
    steps = np.diff(time)
    usual = float(np.median(steps[steps > 0])) if (steps > 0).any() else 1.0
    stretch = np.concatenate([[0], np.cumsum((steps <= 0) | (steps > _PAUSE * usual))])
    areas = 0.5 * (rate[1:] + rate[:-1]) * np.clip(steps, 0.0, _PAUSE * usual)
    return values, np.concatenate([[0.0], np.cumsum(areas)]), stretch


def _difference(values: NDArray[np.float64], stretch: NDArray[np.int64], lag: int) -> NDArray[np.float64]:
    same = stretch[lag:] == stretch[: -lag or None][: max(len(stretch) - lag, 0)]
    return np.asarray((values[lag:] - values[: max(len(values) - lag, 0)])[same])


def _fit(changes: NDArray[np.float64], integrals: NDArray[np.float64]) -> Slope | None:
    """Return the slope through zero, outliers left out in two rounds."""
    for _ in range(3):
        if len(changes) < _FEWEST:
            return None
        square, power = float(integrals @ integrals), float(changes @ changes)
        if square <= 0.0 or power <= 0.0:
            return None
        product = float(changes @ integrals)
        found = Slope(product / square, product / np.sqrt(square * power))
        error = np.abs(changes - found.factor * integrals)
        kept = error <= _OUTLIER * max(float(np.median(error)), 1e-12 * float(np.abs(changes).max()))
        if kept.all() or kept.mean() < 0.5:
            break
        changes, integrals = changes[kept], integrals[kept]
    return found
