"""Coverage: which parts of a recording were kept, interpolated, dropped or never recorded."""

import numpy as np
import pandas as pd

from simgap.recordings.cleaning.work import COVERAGE_COLUMNS, RunUnderCleaning


def coverage(runs: list[RunUnderCleaning]) -> pd.DataFrame:
    """Return, in the order of time, the stretches that were kept, interpolated, dropped or never recorded."""
    parts = [pd.DataFrame(dict(zip(COVERAGE_COLUMNS, _coverage(run), strict=True))) for run in runs]
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=list(COVERAGE_COLUMNS))


def _coverage(run: RunUnderCleaning) -> tuple[str, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the columns of one run, with a row before each stretch that begins after a gap."""
    numbers, names = _states(run)
    other = run.stretch[1:] != run.stretch[:-1]
    edges = np.concatenate([[0], np.flatnonzero((numbers[1:] != numbers[:-1]) | other) + 1, [len(numbers)]])
    first, past = edges[:-1], edges[1:]
    start, end = run.time[first], run.time[past - 1] + run.time_step
    state, reason = np.array(names, dtype=object)[numbers[first]].T
    gaps = 1 + np.flatnonzero(other[first[1:] - 1])
    return (
        run.name,
        np.insert(start, gaps, end[gaps - 1]),
        np.insert(end, gaps, start[gaps]),
        np.insert(state, gaps, "missing"),
        np.insert(reason, gaps, "gap in the recording"),
    )


def _states(run: RunUnderCleaning) -> tuple[np.ndarray, list[tuple[str, str]]]:
    """Return the number of the state of each sample, and state and reason of each number.

    They are told by what happened to the needed channels, by that of the first one where it happened to several.
    """
    count = len(run.reasons)
    state = np.zeros(len(run.time), dtype=np.int16)
    for place in reversed(run.index(run.needed)):
        np.copyto(state, run.cause[:, place], where=run.cause[:, place] > 0)
    np.copyto(state, run.dropped + np.int16(count), where=run.dropped > 0)
    interpolated, dropped = (
        [(name, reason) for reason in run.reasons] for name in ("interpolated", "dropped")
    )
    return state, [("kept", ""), *interpolated[1:], *dropped]
