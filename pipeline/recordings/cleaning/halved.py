"""Speeds that halve from one sample to the next and double back: a sensor that misses every other of its counts.

Nothing that has mass does so. A sensor that loses contact altogether tells zero instead, until it is back.
"""

import itertools

import numpy as np

from simgap.recordings.cleaning.work import RunUnderCleaning

SPEEDS = {
    "quadrotor": [f"motor_speed_{rotor}" for rotor in "1234"],
    "swerve": [f"drive_velocity_{module}" for module in "1234"],
}
"""Speeds that are counted, and have no position beside them that would tell."""

_HALF = 0.08  # by which the ratio of two neighbours may be off a half
_FAST = 0.3  # of the largest speed: below it, a speed may halve in a sample
_QUIET = 0.15  # of the jump: what the speed changes in the samples before and after
_LONGEST = 0.5  # share of a run that may be mended


def mend_halved(run: RunUnderCleaning) -> None:
    """Double what is half for a while, and erase what is zero for a while, and say so."""
    for column in SPEEDS.get(run.kind, []):
        if column not in run.columns:
            continue
        halves, zeros = (_dropped_to(share, run.column(column)) for share in (0.5, 0.0))
        for rows, mend in ((halves, _double), (zeros, _leave_out)):
            if 0 < rows.sum() <= _LONGEST * len(rows):
                mend(run, column, rows)


def _double(run: RunUnderCleaning, column: str, rows: np.ndarray) -> None:
    run.replace(rows, column, 2.0 * run.column(column), "halved", "is half of what it was")
    run.remarks.append(
        f"Channel {column!r} falls to half from one sample to the next, and comes back, in {int(rows.sum())} samples "
        f"of run {run.name!r}; it was doubled there."
    )


def _leave_out(run: RunUnderCleaning, column: str, rows: np.ndarray) -> None:
    run.erase(rows, [column], "halved", "falls to zero at once, and comes back")
    run.remarks.append(
        f"Channel {column!r} falls to zero from one sample to the next, and comes back, in {int(rows.sum())} samples "
        f"of run {run.name!r}; these were left out."
    )


def _dropped_to(share: float, values: np.ndarray) -> np.ndarray:
    """Return where a speed is a share of what it was just before and is just after, (samples,)."""
    rows = np.zeros(len(values), dtype=bool)
    known = np.flatnonzero(np.isfinite(values))
    present = values[known]
    if len(present) < 4:
        return rows
    before, after = present[:-1], present[1:]
    fast = _FAST * np.abs(present).max()
    down = (np.abs(before) > fast) & (np.abs(after - share * before) < _HALF * np.abs(before))
    up = (np.abs(after) > fast) & (np.abs(before - share * after) < _HALF * np.abs(after))
    step = np.abs(np.diff(present))
    calm = np.maximum(np.append(step[1:], 0.0), np.insert(step[:-1], 0, 0.0)) < _QUIET * step
    edges = sorted(
        [(place, 1) for place in 1 + np.flatnonzero(down & calm)]
        + [(place, -1) for place in 1 + np.flatnonzero(up & calm)]
    )
    for (first, begins), (past, ends) in itertools.pairwise(edges):
        if begins > 0 > ends:
            rows[known[first:past]] = True
    return rows
