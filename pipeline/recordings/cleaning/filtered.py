"""A joint's velocity that is a late moving average of the position's rate of change.

Many drives count how far a joint went in the last so many samples. Such a velocity is late by half of that time, and
smoother than the motion. No effect of the catalogue is like it, so the rate of the position takes its place.
"""

from collections.abc import Iterator

import numpy as np
from scipy.signal import lfilter, savgol_filter

from simgap.recordings.cleaning.work import RunUnderCleaning

_WIDTHS = range(4, 61)  # samples; a shorter average is hardly late
_LAGS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)  # time constants of a filter, samples
_BETTER = 0.5  # energy of the error, against every other explanation
_FEWEST = 200  # samples
_JUDGED = 20_000  # samples of a run that are compared; more of them would say the same
_SMOOTHING, _ORDER = 5, 2  # samples and degree of the polynomial whose slope is taken


def replace_averaged(run: RunUnderCleaning) -> None:
    """Put the rate of the position in the place of a velocity that is a moving average of it."""
    if run.kind != "joint" or "velocity" not in run.columns or len(run.time) < _FEWEST:
        return
    velocity, position = run.column("velocity"), run.column("position")
    steps = np.diff(run.time)
    if np.isnan(velocity).any() or np.isnan(position).any() or np.ptp(steps) > 0.5 * run.time_step:
        return
    width = averaged_over(velocity, position, run.time_step)
    if width == 0:
        return
    rate = savgol_filter(position, _SMOOTHING, _ORDER, deriv=1, delta=run.time_step)
    seconds = width * run.time_step
    how = f"a moving average over {seconds:.3g} s"
    run.replace(np.ones(len(rate), dtype=bool), "velocity", rate, "filtered", how)
    run.remarks.append(
        f"Channel 'velocity' is {how} of the position's rate of change, and so {0.5 * seconds:.2g} s late: "
        f"the rate of change took its place in run {run.name!r}."
    )


def averaged_over(velocity: np.ndarray, position: np.ndarray, time_step: float) -> int:
    """Return over how many samples a velocity is averaged, zero if it is no moving average.

    It has to be met twice as well, in energy, as by the rate itself, by a pure delay and by a first-order filter.

    Args:
        velocity: shape (samples,).
        position: shape (samples,).
        time_step: s.
    """
    rate = np.gradient(position, time_step)
    past = max(_WIDTHS)
    rows = np.arange(past, len(velocity) - past, max(len(velocity) // _JUDGED, 1))
    judged = velocity[rows]

    def error(expected: np.ndarray) -> float:
        return float(np.mean((judged - expected) ** 2))

    averages = {}
    for width in _WIDTHS:
        way, next_way = (
            (position[at] - position[at - width]) / (width * time_step) for at in (rows, rows + 1)
        )
        # The mean of both is that of the rate, as `np.gradient` takes it, over as many samples.
        averages[width] = min(error(way), error(0.5 * (way + next_way)))
    width = min(averages, key=lambda each: averages[each])

    def others() -> Iterator[float]:
        yield from (error(rate[rows - delay]) for delay in range(max(_WIDTHS) // 2))
        for lag in _LAGS:
            kept = float(np.exp(-1.0 / lag))
            yield error(lfilter([1.0 - kept], [1.0, -kept], rate)[rows])

    return width if all(averages[width] < _BETTER * other for other in others()) else 0
