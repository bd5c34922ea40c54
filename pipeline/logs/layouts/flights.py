"""When a vehicle flies: from take-off to landing, without the ground."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from simgap.logs.common_times import values_at
from simgap.logs.log import Log, Signal, Span

_CLEAR = 0.3  # m above the ground; more than a barometer drifts in some seconds (0.1 m), less than any flight rises
_SHORTEST = 2.0  # s; a hop, or a detector of landing that was wrong


@dataclass(frozen=True)
class Stretch:
    """A time in which the vehicle says that it is not on the ground.

    Attributes:
        begin: s.
        end: s.
        from_ground: whether it stood before.
        to_ground: whether it stood afterwards.
    """

    begin: float
    end: float
    from_ground: bool = True
    to_ground: bool = True


def stretches(times: NDArray[np.float64], flying: NDArray[np.bool_], end: float) -> list[Stretch]:
    """Return the stretches in which a state holds.

    Args:
        times: at which it was told, s, increasing, (n,).
        flying: the state from then on, (n,).
        end: of the log, s.
    """
    if not len(times):
        return []
    change = np.flatnonzero(np.diff(flying.astype(int))) + 1
    edges = [0, *change.tolist(), len(times)]
    return [
        Stretch(
            float(times[first]),
            float(times[after]) if after < len(times) else end,
            from_ground=first > 0,
            to_ground=after < len(times),
        )
        for first, after in pairwise(edges)
        if flying[first]
    ]


def states_at(times: NDArray[np.float64], signal: Signal, missing: float) -> NDArray[np.float64]:
    """Return what a flag was at some times; `missing` before it was first told."""
    return np.nan_to_num(values_at(signal, times, held=True), nan=missing)


def flights(said: Iterable[Stretch], height: Signal | None) -> tuple[Span, ...]:
    """Return the flights, each from where it is clear of the ground to where it is no more.

    Args:
        said: what the vehicle says.
        height: m, up; None where it is not known, and what the vehicle says is believed.
    """
    found = [span for stretch in said for span in _airborne(stretch, height)]
    return tuple(Span(f"flight_{number}", *span) for number, span in enumerate(found, 1))


def _airborne(stretch: Stretch, height: Signal | None) -> Iterator[tuple[float, float]]:
    begin, end = stretch.begin, stretch.end
    if height is not None:
        inside = (height.time >= begin) & (height.time <= end) & np.isfinite(height.values)
        time, values = height.time[inside], height.values[inside]
        if not len(time):
            return
        if stretch.from_ground:
            clear = np.flatnonzero(values > values[0] + _CLEAR)
            begin = float(time[clear[0]]) if len(clear) else end
        if stretch.to_ground:
            clear = np.flatnonzero(values > values[-1] + _CLEAR)
            end = float(time[clear[-1]]) if len(clear) else begin
    if end - begin >= _SHORTEST:
        yield begin, end


def height_of(log: Log, names: Iterable[tuple[str, float]]) -> Signal | None:
    """Return the first signal that is there, times its factor; None where none is there."""
    for name, factor in names:
        if name in log.signals and len(log.signals[name].time):
            signal = log.signals[name]
            return Signal(name, signal.time, factor * signal.values, signal.unit)
    return None


def rise(height: Signal | None) -> float:
    """Return how far the height changes, m; 0 where it is not known."""
    if height is None or not np.isfinite(height.values).any():
        return 0.0
    return float(np.nanmax(height.values) - np.nanmin(height.values))
