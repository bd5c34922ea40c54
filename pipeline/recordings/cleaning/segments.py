"""Unbroken stretches: unusable samples and short stretches are dropped, the rest is numbered."""

import numpy as np

from simgap.recordings.cleaning.work import RunUnderCleaning

_GAP_ROUNDING = 1.0 - 1e-9


def drop_incomplete(run: RunUnderCleaning) -> None:
    """Drop samples in which a required channel is missing for too long to interpolate."""
    for column, place in zip(run.needed, run.index(run.needed), strict=True):
        rows = np.isnan(run.column(column))
        if not rows.any():
            continue
        rows &= run.dropped == 0
        causes = run.cause[:, place]
        for cause in sorted(run.reasons[number] for number in np.unique(causes[rows])):
            run.drop(
                rows & (causes == run.number(cause)),
                "gaps",
                "required channel missing for too long to interpolate",
                f"{column} ({cause})",
            )


def drop_short(run: RunUnderCleaning, min_duration: float) -> None:
    """Drop unbroken stretches shorter than `min_duration` s, and single samples."""
    rows = np.zeros(len(run.time), dtype=bool)
    least = max(2, int(np.ceil(min_duration * _GAP_ROUNDING / run.time_step)))
    short = [piece for piece in unbroken(run) if np.diff(piece)[0] < least]
    for first, past in short:
        rows[first:past] = True
    run.drop(rows, "short", f"less than {min_duration:g} s without a gap", f"{len(short)} stretches")


def drop_made_up(run: RunUnderCleaning, least_measured: float) -> None:
    """Drop unbroken stretches in which a required channel was measured for less than a share of the time."""
    causes = [run.cause[:, place] for place in run.index(run.needed)]
    for first, past in unbroken(run):
        share = min(np.count_nonzero(cause[first:past] == 0) for cause in causes) / (past - first)
        if share < least_measured:
            rows = np.zeros(len(run.time), dtype=bool)
            rows[first:past] = True
            run.drop(
                rows, "gaps", "mostly interpolated", f"{share:.0%} measured from t = {run.time[first]:.6g} s"
            )


def unbroken(run: RunUnderCleaning) -> np.ndarray:
    """Return the kept stretches as rows [first, one past last], shape (stretches, 2)."""
    kept = np.concatenate([[False], run.dropped == 0, [False]])
    joined = np.concatenate([[False], run.stretch[1:] == run.stretch[:-1], [False]]) & kept[1:] & kept[:-1]
    first = np.flatnonzero(kept[1:-1] & ~joined[:-1])
    last = np.flatnonzero(kept[1:-1] & ~joined[1:])
    return np.stack([first, last + 1], axis=1)


def segment_numbers(run: RunUnderCleaning) -> np.ndarray:
    """Return the number of the unbroken stretch of each sample, −1 where dropped, shape (samples,)."""
    numbers = np.full(len(run.time), -1)
    for number, (first, past) in enumerate(unbroken(run)):
        numbers[first:past] = number
    return numbers
