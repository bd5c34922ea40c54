"""Where the runs of a table lie: its rows of one run are neighbours, so that a run is a slice and no copy."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from numpy.typing import NDArray


def stretches_of_runs(run: pd.Series) -> tuple[list[str], NDArray[np.int64]]:
    """Return the names of the stretches of rows that name one run, and where each begins; the end of all comes last.

    Args:
        run: name of each row, (rows,).
    """
    names = run.array
    other = np.asarray(names[1:] != names[:-1], dtype=bool)
    edges = np.concatenate([[0], np.flatnonzero(other) + 1, [len(names)]])
    begins = edges[:-1] if len(names) else edges[:0]
    return [str(name) for name in names.take(begins)], edges if len(names) else edges[:1]


def by_run(frame: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield the name and the rows of each run, in the order in which they appear.

    Args:
        frame: with a column `run`.
    """
    names, edges = stretches_of_runs(frame["run"])
    if len(set(names)) < len(names):  # the rows of two runs are mixed
        yield from ((str(name), rows) for name, rows in frame.groupby("run", sort=False))
        return
    for name, begin, end in zip(names, edges[:-1], edges[1:], strict=True):
        yield name, frame.iloc[begin:end]


def column_of_runs(names: list[str], lengths: list[int], like: pd.Series) -> pd.Series:
    """Return the column of so many rows of each run, of the type of another one, which it shares if both are alike."""
    there, edges = stretches_of_runs(like)
    if there == names and np.diff(edges).tolist() == lengths:
        return like.reset_index(drop=True)
    return pd.Series(names, dtype=like.dtype, name="run").repeat(lengths).reset_index(drop=True)
