"""Motions on disk: one table of all of them, a row per sample."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.policies.profile.motion import Motion

FILE = "motions.parquet"
_COLUMNS = {"name", "t", "position", "velocity"}


def write_motions(motions: Mapping[str, Motion], folder: Path) -> None:
    """Write motions by name: `t` s, `position` m, `velocity` m/s and `voltage_N` V, held until the next sample."""
    frames = [_frame(name, motion) for name, motion in motions.items()]
    pd.concat(frames, ignore_index=True).to_parquet(folder / FILE, index=False)


def read_motions(path: Path) -> dict[str, Motion]:
    """Read what `write_motions` wrote.

    Raises:
        InputError: when it is something else.
    """
    try:
        table = pd.read_parquet(path)
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read: {error}", str(path), "run simgap profile") from error
    if not set(table) >= _COLUMNS:
        raise InputError("is no table of motions", str(path), "run simgap profile")
    return {str(name): _motion(rows) for name, rows in table.groupby("name", sort=False)}


def _frame(name: str, motion: Motion) -> pd.DataFrame:
    # The last sample ends the motion: no voltage is held from there.
    voltage = np.concatenate([motion.voltage, np.zeros_like(motion.voltage[:1])])
    columns = {f"voltage_{wheel + 1}": series for wheel, series in enumerate(voltage.T)}
    return pd.DataFrame(
        {"name": name, "t": motion.time, "position": motion.position, "velocity": motion.velocity} | columns
    )


def _motion(rows: pd.DataFrame) -> Motion:
    voltage = rows.filter(like="voltage_").to_numpy(dtype=np.float64, copy=True)
    time, position, velocity = (
        rows[name].to_numpy(dtype=np.float64, copy=True) for name in ("t", "position", "velocity")
    )
    return Motion(float(time[1] - time[0]), position, velocity, voltage[:-1])
