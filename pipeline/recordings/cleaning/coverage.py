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
    state, reason = _states(run)
    change = (state[1:] != state[:-1]) | (reason[1:] != reason[:-1]) | (run.stretch[1:] != run.stretch[:-1])
    edges = np.concatenate([[0], np.flatnonzero(change) + 1, [len(state)]])
    rows: list[tuple[str, float, float, str, str]] = []
    for first, past in itertools.pairwise(edges):
        start, end = float(run.time[first]), float(run.time[past - 1]) + run.time_step
        if first and run.stretch[first] != run.stretch[first - 1]:
            rows.append((run.name, rows[-1][2], start, "missing", "gap in the recording"))
        rows.append((run.name, start, end, str(state[first]), str(reason[first])))
    return rows


def _states(run: RunUnderCleaning) -> tuple[np.ndarray, np.ndarray]:
    """Return state and reason of each sample, by what happened to its needed channels."""
    causes = run.cause[:, run.index(run.needed)]
    reason = np.full(len(run.time), "", dtype=object)
    for place in range(causes.shape[1]):
        reason = np.where(reason == "", causes[:, place], reason)
    state = np.where(reason == "", "kept", "interpolated")
    gone = run.dropped != ""
    return np.where(gone, "dropped", state), np.where(gone, run.dropped, reason)
