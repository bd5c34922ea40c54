"""A joint's velocity that is a late moving average of the position's rate of change.

Many drives count how far a joint went in the last so many samples. Such a velocity is late by half of that time, and
smoother than the motion. No effect of the catalogue is like it, so the rate of the position takes its place.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.signal import lfilter, savgol_filter

from simgap.recordings.cleaning.work import WHERE, RunUnderCleaning

_SHORTEST, _EVERY, _COARSER = 4, 60, 1.05
"""Widths of an average that are tried, samples: a shorter one is hardly late; all up to here; then by a factor."""
_LONGEST, _LONGEST_SHARE = 0.5, 0.25
"""Of them, s and of a run: in the published `swerve_drive`, motor controllers average over some 0.3 s."""
_UNEVEN, _GAP = 0.5, 10.0
"""Steps: times that differ by less are even; over a longer gap no position is interpolated."""
_LAGS = tuple(size * 2**octave for octave in range(9) for size in (0.5, 0.75))
"""Time constants of a filter that are tried, samples."""
_NARROWER = 4  # times as narrow is an average that is taken for the rate itself, without its noise
_BETTER = 0.5  # energy of the error, against every other explanation
_FEWEST = 200  # samples
_JUDGED = 20_000  # samples of a run that are compared; more of them would say the same
_SMOOTHING, _ORDER = 5, 2  # samples and degree of the polynomial whose slope is taken


def replace_averaged(run: RunUnderCleaning) -> None:
    """Put the rate of the position in the place of a velocity that is a moving average of it."""
    if run.kind != "joint" or "velocity" not in run.columns or len(run.time) < _FEWEST:
        return
    steps = np.diff(run.time)
    whole = not (np.isnan(run.column("velocity")).any() or np.isnan(run.column("position")).any())
    if not whole or steps.max() > _GAP * run.time_step:
        return
    time, velocity, position = _evenly(run, steps)
    width = averaged_over(velocity, position, run.time_step)
    if width == 0:
        return
    slope = savgol_filter(position, _SMOOTHING, _ORDER, deriv=1, delta=run.time_step)
    rate = np.interp(run.time, time, slope)
    seconds = width * run.time_step
    how = f"a moving average over {seconds:.2g} s"
    run.replace(np.ones(len(rate), dtype=bool), "velocity", rate, "filtered", how)
    run.remarks.append(
        f"Channel 'velocity' is {how} of the position's rate of change, and so {0.5 * seconds:.2g} s late: "
        f"the rate of change took its place in {WHERE}."
    )


def _evenly(run: RunUnderCleaning, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, velocity and position of a run at even times: as recorded, or interpolated."""
    columns = run.column("velocity"), run.column("position")
    if np.ptp(steps) <= _UNEVEN * run.time_step:
        return run.time, *columns
    even = np.arange(run.time[0], run.time[-1], run.time_step)
    velocity, position = (np.interp(even, run.time, series) for series in columns)
    return even, velocity, position


def averaged_over(velocity: np.ndarray, position: np.ndarray, time_step: float) -> int:
    """Return over how many samples a velocity is averaged, zero if it is no moving average.

    It has to be met twice as well, in energy, as by the rate itself and by a pure delay, each with and without
    smoothing that is not late, and as by a first-order filter.

    Args:
        velocity: shape (samples,).
        position: shape (samples,).
        time_step: s.
    """
    widths = _widths(len(velocity), time_step)
    margin = widths[-1] + 1
    rows = np.arange(margin, len(velocity) - margin // 2 - 1, max(len(velocity) // _JUDGED, 1))

    def error(expected: np.ndarray) -> float:
        return float(np.mean((velocity[rows] - expected) ** 2))

    def average(width: int, last: int) -> float:
        """Return the error of the mean rate over samples of which the last one lies so far after each row."""
        ways = (position[at + last] - position[at + last - width] for at in (rows, rows + 1))
        first, second = (way / (width * time_step) for way in ways)
        # The mean of both is that of the rate, as `np.gradient` takes it, over as many samples.
        return min(error(first), error(0.5 * (first + second)))

    found = {width: average(width, 0) for width in widths}
    width = min(found, key=lambda each: found[each])

    def others() -> Iterator[float]:
        yield average(width, width // 2)
        rate = np.gradient(position, time_step)
        for delay in _delays(widths):
            yield error(rate[rows - delay])
            yield average(width // _NARROWER, width // _NARROWER // 2 - delay)
        for lag in (each for each in _LAGS if each <= widths[-1]):
            kept = float(np.exp(-1.0 / lag))
            yield error(lfilter([1.0 - kept], [1.0, -kept], rate)[rows])

    return width if all(found[width] < _BETTER * other for other in others()) else 0


def _widths(samples: int, time_step: float) -> Sequence[int]:
    """Return the widths that are tried in a run, in samples."""
    longest = min(_LONGEST / time_step, _LONGEST_SHARE * samples)
    widths = list(range(_SHORTEST, _EVERY + 1))
    while widths[-1] * _COARSER < longest:
        widths.append(round(widths[-1] * _COARSER))
    return widths


def _delays(widths: Sequence[int]) -> list[int]:
    """Return the delays that an average is told from, in samples: up to that of the longest one."""
    return sorted({*range(_SHORTEST), *(width // 2 for width in widths)})
