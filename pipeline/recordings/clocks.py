"""Clocks that start anew in the middle of a run, and what to do with times that are out of order."""

import numpy as np
import pandas as pd

_FEWEST = 20  # samples of a stretch that is a run of its own
_TWO_SOURCES = 0.1  # share of the rows that are out of order: no clock fails so often


def runs_of_one_clock(run: pd.Series, time: pd.Series) -> tuple[pd.Series, list[str]]:
    """Return the run of each row, where a run whose clock starts anew is two, and a sentence about each.

    Rows are never sorted by time: that would interleave two stretches.

    Args:
        run: name of each row.
        time: s, of each row.
    """
    times = time.to_numpy()
    if not (times[1:] < times[:-1]).any():
        return run, []
    codes = pd.factorize(run)[0]
    order = np.argsort(codes, kind="stable")
    if not ((np.diff(time.to_numpy()[order]) < 0) & (np.diff(codes[order]) == 0)).any():
        return run, []
    names, remarks = run.to_numpy(dtype=object, copy=True), []
    for name, rows in run.groupby(run, sort=False).groups.items():
        places = np.asarray(rows)
        times = time.to_numpy()[places]
        back = np.flatnonzero(np.diff(times) < 0) + 1
        lengths = np.diff([0, *back, len(places)])
        # What is ahead again one row later was one wrong time, and no clock that started anew.
        if not len(back) or lengths.min() < _FEWEST or (times[back + 1] > times[back - 1]).any():
            continue
        parts = np.repeat(np.arange(len(lengths)), lengths)
        titles = _titles(str(name), len(lengths), set(run))
        names[places] = np.array(titles, dtype=object)[parts]
        remarks.append(
            f"The clock of run {str(name)!r} starts anew at row {int(places[back[0]]) + 1}: it was taken as "
            f"{'two' if len(lengths) == 2 else len(lengths)} runs, {', '.join(map(repr, titles))}."
        )
    return pd.Series(names, index=run.index, name=run.name).astype(run.dtype), remarks


def clock_remedy(wrong: np.ndarray, twice: bool) -> str:
    """Return what to do with times that do not increase.

    Args:
        wrong: where they do not, (rows,).
        twice: whether the first of them repeats a time.
    """
    if np.mean(wrong) > _TWO_SOURCES:
        return "two sources seem to write into one run: keep the rows of one of them"
    if twice:
        return "keep one row per time; where two sources write into one run, keep the rows of one"
    return "leave out the row, or give what follows a run of its own if the clock was reset there; do not sort by time"


def _titles(name: str, count: int, taken: set[str]) -> list[str]:
    titles = [name]
    number = 2
    while len(titles) < count:
        title = f"{name} ({number})"
        number += 1
        if title not in taken:
            titles.append(title)
    return titles
