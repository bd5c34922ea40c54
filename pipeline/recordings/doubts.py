"""Warnings about a recording that can be used but looks wrong, one sentence each."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from simgap.recordings.runs import by_run, stretches_of_runs

LARGEST_AT = "It is largest at"
"""Begins the sentence that tells where a simulator fails most; there is none where it fails everywhere."""
SINGLE_RUN = "There is only one run, so none can be held out for validation."
_GAP_STEPS = 20  # samples missing in a row
_GAP_SECONDS = 1.0


def doubts(frame: pd.DataFrame, kind: str, units: dict[str, str]) -> tuple[str, ...]:
    """Return the warnings about a valid frame.

    Args:
        frame: `run`, `t` and the channels, in the contract's units.
        kind: quadrotor, swerve or joint.
        units: unit of each channel.
    """
    return (
        *_without_position(frame, kind),
        *_gaps(frame),
        *_constant(frame, units),
        *_single_run(frame),
    )


def _without_position(frame: pd.DataFrame, kind: str) -> Iterator[str]:
    if kind == "quadrotor" and "position_x" not in frame:
        thrust = " and the thrust along body z" if "specific_force_z" in frame else ""
        yield (
            f"Position, velocity and attitude were not recorded: the rotation{thrust} can be judged, and the motors. "
            "Drag, wind, ground effect and all else that depends on speed, height or attitude can be neither found nor "
            "ruled out."
        )


def _gaps(frame: pd.DataFrame) -> Iterator[str]:
    for run, samples in by_run(frame):
        time = samples["t"].to_numpy()
        if len(time) < 3:
            continue
        typical = float(np.median(np.diff(time), overwrite_input=True))
        steps = np.diff(time)
        if typical > _GAP_SECONDS:
            yield f"Run {run!r} has one sample every {typical:.3g} s: are the times in milliseconds instead of seconds?"
        wide = steps > max(_GAP_SECONDS, _GAP_STEPS * typical)
        if wide.any():
            longest = int(np.argmax(steps))
            yield (
                f"Run {run!r} has {int(wide.sum())} gap(s) in time; the longest is {steps[longest]:.3g} s"
                f" after t = {time[longest]:.6g} s (row {int(samples.index[longest]) + 1})."
            )


def _constant(frame: pd.DataFrame, units: dict[str, str]) -> Iterator[str]:
    if len(frame) < 3:
        return
    for column in units:
        values = frame[column].to_numpy()
        least = np.fmin.reduce(values)
        if least == np.fmax.reduce(values) and np.isfinite(values).sum() > 2:
            yield f"Channel {column!r} is constant ({least:.6g}) in the whole recording."


def _single_run(frame: pd.DataFrame) -> Iterator[str]:
    names, _ = stretches_of_runs(frame["run"])
    if len(set(names)) == 1:
        yield SINGLE_RUN
