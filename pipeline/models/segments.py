"""The unbroken stretches of a cleaned recording, with actuators and state on one clock."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from simgap.recordings.recording import Recording

_ACTUATOR_STEMS = ("motor_speed_", "motor_command_")


@dataclass(frozen=True)
class Segment:
    """One unbroken, uniformly sampled stretch of a run.

    Attributes:
        run: its name.
        frame: `t` in s and the channels, one row per sample.
    """

    run: str
    frame: pd.DataFrame

    def columns(self, names: Sequence[str]) -> np.ndarray:
        """Return channels as (samples, names) float64."""
        return self.frame[list(names)].to_numpy(dtype=np.float64, copy=True)


def segments(recording: Recording, runs: Sequence[str] | None = None) -> Iterator[Segment]:
    """Yield the segments of some runs (all by default), in the order of the recording.

    The motors of a quadrotor are moved onto the clock of the state by the offset that cleaning estimated.
    """
    wanted = set(recording.runs if runs is None else runs)
    keys = ["run", "segment"] if "segment" in recording.frame else ["run"]
    for _, frame in recording.frame.groupby(keys, sort=False):
        run = str(frame["run"].iloc[0])
        if run in wanted:
            yield Segment(run, _on_one_clock(frame, recording.clock_offset.get(run, 0.0)))


def _on_one_clock(frame: pd.DataFrame, offset: float) -> pd.DataFrame:
    """Shift the actuators by the time by which the state is late; samples without a partner are dropped."""
    actuators = [column for column in frame if str(column).startswith(_ACTUATOR_STEMS)]
    if offset == 0.0 or not actuators:
        return frame
    time = frame["t"].to_numpy(dtype=np.float64, copy=True)
    then = time - offset
    shifted = frame.copy()
    for column in actuators:
        shifted[column] = np.interp(then, time, frame[column].to_numpy(dtype=np.float64, copy=True))
    return shifted[(then >= time[0]) & (then <= time[-1])]
