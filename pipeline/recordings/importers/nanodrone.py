"""Flights of the nano-drone system-identification benchmark (arXiv 2512.14450): Parquet, one run per file."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from scipy.spatial.transform import Rotation

from simgap.recordings.importers.columns import Column, check_options, take, vector
from simgap.recordings.recording import Recording, recording_from_frame
from simgap.recordings.storage import read_table

_POLE_PAIRS = 6
_MECHANICAL = 2 * math.pi / (60 * _POLE_PAIRS)  # rad/s of the rotor per electrical turn per minute

# The state is the one that the benchmark predicts: the on-board estimate, which is fed by motion capture. The
# motion capture's own position is left out: in some runs it lags by over 0.1 s, in others it jumps.
_COLUMNS = (
    {"t": Column("t", "s")}
    | vector("position", ("x", "y", "z"), "m")
    | vector("attitude", ("qw", "qx", "qy", "qz"), axes="wxyz")
    | vector("velocity", ("vx", "vy", "vz"), "m/s")
    | vector("body_rate", ("wx", "wy", "wz"), "rad/s")
    | vector("motor_speed", (f"m{rotor}_erpm" for rotor in "1234"), "rad/s", "1234", _MECHANICAL)
    | vector("motor_command", (f"m{rotor}_thrust" for rotor in "1234"), "1", "1234")
    | {"battery_voltage": Column("Vbat", "V")}
    | vector("specific_force", ("ax", "ay", "az"), "m/s²")
)
_FORCE = [f"specific_force_{axis}" for axis in "xyz"]
_SCALAR_LAST = [f"attitude_{axis}" for axis in "xyzw"]


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read flights; the specific force, published along world axes, is turned into the body frame.

    Args:
        paths: Parquet files of `raw_parquet`.
        options: none.

    Raises:
        InputError: when a file is not of this format.
    """
    check_options(options, (), "nanodrone")
    frames = []
    for path in paths:
        raw = read_table(path).frame
        frame = take(raw, _COLUMNS, "quadrotor", pd.Series([path.stem] * len(raw)), str(path))
        attitude = Rotation.from_quat(frame[_SCALAR_LAST].to_numpy(copy=True))
        frame[_FORCE] = attitude.inv().apply(frame[_FORCE].to_numpy(copy=True))
        frames.append(frame)
    return recording_from_frame(pd.concat(frames, ignore_index=True), "quadrotor")
