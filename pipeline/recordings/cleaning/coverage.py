"""Coverage: which parts of a recording were kept, interpolated, dropped or never recorded."""

import itertools

import numpy as np
import pandas as pd

from simgap.recordings.cleaning.work import COVERAGE_COLUMNS, RunUnderCleaning


def coverage(runs: list[RunUnderCleaning]) -> pd.DataFrame:
    """Return, in the order of time, the stretches that were kept, interpolated, dropped or never recorded."""
    rows = [row for run in runs for row in _coverage(run)]
    return pd.DataFrame(rows, columns=list(COVERAGE_COLUMNS)).astype({"start": "float64", "end": "float64"})


def _coverage(run: RunUnderCleaning) -> list[tuple[str, float, float, str, str]]:
    state, names = _states(run)
    change = (state[1:] != state[:-1]) | (run.stretch[1:] != run.stretch[:-1])
    edges = np.concatenate([[0], np.flatnonzero(change) + 1, [len(state)]])
    rows: list[tuple[str, float, float, str, str]] = []
    for first, past in itertools.pairwise(edges):
        start, end = float(run.time[first]), float(run.time[past - 1]) + run.time_step
        if first and run.stretch[first] != run.stretch[first - 1]:
            rows.append((run.name, rows[-1][2], start, "missing", "gap in the recording"))
        rows.append((run.name, start, end, *names[state[first]]))
    return rows


def _states(run: RunUnderCleaning) -> tuple[np.ndarray, list[tuple[str, str]]]:
    """Return the number of the state of each sample, and state and reason of each number.

    They are told by what happened to the needed channels, by that of the first one where it happened to several.
    """
    numbers = {("kept", ""): 0}
    state = np.zeros(len(run.time), dtype=np.int64)
    columns = [("interpolated", run.cause[:, place]) for place in reversed(run.index(run.needed))]
    for name, reasons in [*columns, ("dropped", run.dropped)]:
        rows = np.flatnonzero(reasons != "")
        state[rows] = [numbers.setdefault((name, reason), len(numbers)) for reason in reasons[rows].tolist()]
    return state, list(numbers)
