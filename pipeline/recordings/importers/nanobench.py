"""Flights of NanoBench (arXiv 2603.09908): CSV, one run per file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from simgap.recordings.importers.columns import Column, check_options, take, vector
from simgap.recordings.recording import Recording, recording_from_frame
from simgap.recordings.storage import read_table

_FULL_COMMAND = 65535  # of the 16-bit pulse-width command
_ESTIMATE = "est_stateEstimate"
_ESTIMATED_ATTITUDE = "att_stateEstimate"

# Position, attitude and velocity are Vicon's, the body rate is the gyroscope's: Vicon's rates are
# differentiated, noisy and along world axes.
_COLUMNS = (
    {"t": Column("t", "s")}
    | vector("position", ("px", "py", "pz"), "m")
    | vector("attitude", ("qw", "qx", "qy", "qz"), axes="wxyz")
    | vector("velocity", ("vx", "vy", "vz"), "m/s")
    | vector("body_rate", (f"imu_gyro_{axis}" for axis in "xyz"), "rad/s")
    | vector("motor_command", (f"motor_motor_m{rotor}" for rotor in "1234"), "1", "1234", 1 / _FULL_COMMAND)
    | {"battery_voltage": Column("pwr_pm_vbat", "V")}
    | vector("specific_force", (f"imu_acc_{axis}" for axis in "xyz"), "g")
    | vector("estimate_position", (f"{_ESTIMATE}_{axis}" for axis in "xyz"), "m")
    | vector("estimate_attitude", (f"{_ESTIMATED_ATTITUDE}_q{axis}" for axis in "wxyz"), axes="wxyz")
    | vector("estimate_velocity", (f"{_ESTIMATE}_v{axis}" for axis in "xyz"), "m/s")
)


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read flights; time, published since 1970, starts at zero in each.

    Args:
        paths: CSV files of `datasets/dataset`.
        options: none.

    Raises:
        InputError: when a file is not of this format.
    """
    check_options(options, (), "nanobench")
    frames = []
    for path in paths:
        raw = read_table(path).frame
        frame = take(raw, _COLUMNS, "quadrotor", pd.Series([path.stem] * len(raw)), str(path))
        frames.append(frame.assign(t=frame["t"] - frame["t"].iloc[0]))
    return recording_from_frame(pd.concat(frames, ignore_index=True), "quadrotor")
