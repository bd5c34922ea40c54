"""Measured against simulated, before and after: traces one over the other, chosen by run and channel."""

import itertools
from typing import Any

import numpy as np
import pandas as pd

from simgap.report.figure import encode, label
from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.text import pretty_unit, spoken

SIGNALS = ("measured", "before", "after")
_GAP = 5.0  # median sampling steps beyond which a line is broken
_FEWEST = 200  # samples that a trace needs to be worth drawing; what would get fewer is left out


def traces_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Show each held-out run's channels as measured and as simulated before and after."""
    table = inputs.evidence("traces.parquet")
    if table is None:
        return None
    groups = list(table.groupby(["run", "channel"], sort=False))
    drawn = groups[: max(drawing.trace_samples // _FEWEST, 1)]
    keep = drawing.trace_samples // len(drawn)
    runs, channels = ([str(name) for name in dict.fromkeys(key[part] for key, _ in drawn)] for part in (0, 1))
    series = [
        {"run": runs.index(str(run)), "channel": channels.index(str(channel))}
        | _series(str(channel), rows, keep)
        for (run, channel), rows in drawn
    ]
    content = {"series": series, "runs": runs, "channels": channels, "left_out": len(groups) - len(drawn)}
    return Section("traces", "Measured against simulated", content)


def thin(times: np.ndarray, values: np.ndarray, keep: int) -> np.ndarray:
    """Choose samples that keep the extremes of every signal.

    Args:
        times: (n,) seconds, increasing.
        values: (n, signals).
        keep: about how many samples to choose.

    Returns:
        Increasing indices of the chosen samples; all where n is at most `keep`.
    """
    count, signals = values.shape
    if count <= keep:
        return np.arange(count)
    buckets = max(keep // (2 * signals), 1)
    ends = np.linspace(0, count, buckets + 1).astype(int)
    filled = np.where(np.isfinite(values), values, 0.0)
    chosen = [0, count - 1]
    for start, end in itertools.pairwise(ends):
        chosen += [*(start + filled[start:end].argmin(axis=0)), *(start + filled[start:end].argmax(axis=0))]
    return np.unique(chosen)


def _series(channel: str, rows: pd.DataFrame, keep: int) -> dict[str, Any]:
    rows = rows.sort_values("t", kind="stable")
    times = rows["t"].to_numpy(dtype=float, copy=True)
    values = rows[list(SIGNALS)].to_numpy(dtype=float, copy=True)
    times, values = _thinned_with_gaps(times - times[0], values, keep)
    unit = pretty_unit(str(rows["unit"].iloc[0])) if "unit" in rows else ""
    columns = {name: encode(values[:, index]) for index, name in enumerate(SIGNALS)}
    # The difference has steps of its own: it may be far smaller than the signal.
    left = {
        f"left_{name}": encode(values[:, 0] - values[:, index])
        for index, name in ((1, "before"), (2, "after"))
    }
    return {"title": label(spoken(channel)), "unit": label(unit), "t": encode(times)} | columns | left


def _thinned_with_gaps(times: np.ndarray, values: np.ndarray, keep: int) -> tuple[np.ndarray, np.ndarray]:
    """Thin, and put a row of NaN where the recording has a gap, so that no line is drawn across it."""
    steps = np.diff(times)
    after_gap = np.flatnonzero(steps > _GAP * np.median(steps)) + 1 if len(steps) else np.array([], dtype=int)
    chosen = np.unique([*thin(times, values, keep), *after_gap, *(after_gap - 1)]).astype(int)
    breaks = np.searchsorted(chosen, after_gap)
    times = np.insert(times[chosen], breaks, times[after_gap])
    return times, np.insert(values[chosen], breaks, np.nan, axis=0)
