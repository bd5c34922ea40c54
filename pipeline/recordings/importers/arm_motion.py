"""Motions of one joint of an SO-101 arm with Feetech STS3215 servos: the format of isaac-sim2real/sage."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.importers.columns import Column, check_options, take
from simgap.recordings.recording import Recording, recording_from_frame
from simgap.recordings.storage import read_table

_OPTION_KEYS = ("joint", "supply", "gain")
_STATE_FILE, _CONTROL_FILE = "state_motor.csv", "control.csv"
_MOST_DUTY = 0.97  # what the servo's firmware lets through
_COLUMNS = {
    "t": Column("timestamp", "us"),
    "position": Column("positions", "rad"),
    "velocity": Column("velocities", "rad/s"),
    "voltage": Column("voltage", "V"),
}


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read a joint of each motion; one run per folder.

    No voltage is recorded, and the current without its sign in three or four steps. The voltage is therefore that of
    the servo's own law, supply · gain · (command − position), from the recorded command and position; its derivative
    part, of which the firmware's scale is not published, is left out.

    Args:
        paths: `control.csv` and `state_motor.csv` of each motion, each in the motion's folder.
        options: `joint`: which of the arm's joints, from 0; `supply`, V; `gain`: duty cycle per rad.

    Raises:
        InputError: when a file or an option is missing, or is not of this format.
    """
    check_options(options, _OPTION_KEYS, "arm_motion")
    joint, supply, gain = (_number(options, key) for key in _OPTION_KEYS)
    folders = sorted({path.parent for path in paths})
    frames = [_frame(folder, paths, int(joint), supply, gain) for folder in folders]
    law = f"the servo's proportional law at {supply:g} V, {gain:g} of full duty per rad"
    remark = f"No voltage was recorded; it is calculated by {law}."
    return recording_from_frame(pd.concat(frames, ignore_index=True), "joint", warnings=[remark])


def _number(options: Mapping[str, Any], key: str) -> float:
    value = options.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or value < 0:
        raise InputError(f"{value!r} is not a number", f"dataset.options.{key}", "give one")
    return float(value)


def _frame(folder: Path, paths: Sequence[Path], joint: int, supply: float, gain: float) -> pd.DataFrame:
    for name in (_STATE_FILE, _CONTROL_FILE):
        if folder / name not in paths:
            raise InputError(f"{name!r} is missing", str(paths[0]), "add it to dataset.files")
    state, control = (read_table(folder / name).frame for name in (_STATE_FILE, _CONTROL_FILE))
    where = str(folder / _STATE_FILE)
    table = pd.DataFrame({"timestamp": _column(state, "timestamp", where)})
    for column in ("positions", "velocities"):
        table[column] = _of_joint(_column(state, column, where), joint, where)
    commanded = str(folder / _CONTROL_FILE)
    if (
        len(control) != len(state)
        or not (_column(control, "timestamp", commanded) == table["timestamp"]).all()
    ):
        raise InputError("its times are not those of the state", commanded, "record both in one loop")
    command = _of_joint(_column(control, "positions", commanded), joint, commanded)
    duty = np.clip(gain * (command - table["positions"]), -_MOST_DUTY, _MOST_DUTY)
    table["voltage"] = supply * duty
    return take(table, _COLUMNS, "joint", pd.Series([folder.name] * len(table)), where)


def _column(table: pd.DataFrame, name: str, where: str) -> pd.Series:
    if name not in table:
        raise InputError(f"column {name!r} is missing", where, "is it the file that the dataset names?")
    return table[name]


def _of_joint(texts: pd.Series, joint: int, where: str) -> np.ndarray:
    """Return one joint's numbers of a column that holds a list in every row."""
    try:
        return np.array([float(json.loads(text)[joint]) for text in texts])
    except (TypeError, ValueError, IndexError) as error:
        raise InputError(
            f"column {texts.name!r} holds no number of joint {joint} ({error})", where, "correct the file"
        ) from None
