"""Logs of a servo that swings a pendulum, as JSON: the format of Better Actuator Models (arXiv 2410.08650)."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.importers.columns import Column, check_options, take
from simgap.recordings.recording import Recording, recording_from_frame

_FULL_DUTY = 885  # of `load` (Present PWM, e-manual of the XL330)
_WORD = 1 << 16  # `load` is a signed number of 16 bits, published without its sign
_COLUMNS = {
    "t": Column("timestamp", "s"),
    "position": Column("position", "rad"),
    "velocity": Column("speed", "rad/s"),
    "battery_voltage": Column("input_volts", "V"),
    "temperature": Column("temp", "°C"),
}
_HEADER = ("trajectory", "kp", "vin")


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read logs as a joint; one run per file, named by its trajectory and the gain of the servo.

    The voltage is the duty cycle times the supply of the log's header. Where the servo was switched off, its
    bridge is open and the pendulum swings free: no voltage is known there, and none is given.

    Args:
        paths: JSON files.
        options: none.

    Raises:
        InputError: when a file is not of this format.
    """
    check_options(options, (), "pendulum_json")
    logs = [_load(path) for path in paths]
    names = [f"{log['trajectory']}_kp{log['kp']}" for log in logs]
    if len(set(names)) < len(names):
        names = [f"{name}_{path.stem}" for name, path in zip(names, paths, strict=True)]
    frames = [_frame(log, name, str(path)) for log, name, path in zip(logs, names, paths, strict=True)]
    frame = pd.concat(frames, ignore_index=True)
    return recording_from_frame(frame, "joint", warnings=_remarks(frame))


def _load(path: Path) -> dict[str, Any]:
    try:
        log = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be read as JSON ({error})", str(path), "give a log of a pendulum test bench"
        ) from None
    for key in (*_HEADER, "entries"):
        if not isinstance(log, dict) or key not in log:
            raise InputError(f"{key!r} is missing", str(path), "give a log of a pendulum test bench")
    if not isinstance(log["entries"], list) or not log["entries"]:
        raise InputError("holds no samples", f"{path}, entries", "record it again")
    return log


def _frame(log: Mapping[str, Any], name: str, where: str) -> pd.DataFrame:
    table = pd.DataFrame(log["entries"])
    run = pd.Series([name] * len(table))
    load = {"voltage": Column("load", "V")}
    frame = take(table, _COLUMNS | load, "joint", run, where)
    signed = (frame["voltage"] + _WORD / 2) % _WORD - _WORD / 2
    switched_on = table["torque_enable"].astype(bool) if "torque_enable" in table else True
    voltage = np.where(switched_on, signed / _FULL_DUTY * float(log["vin"]), np.nan)
    return frame.assign(voltage=voltage)


def _remarks(frame: pd.DataFrame) -> Iterable[str]:
    free = frame["voltage"].isna().groupby(frame["run"], sort=False).any()
    if free.any():
        yield (
            f"The servo is switched off in a part of {int(free.sum())} runs; the voltage is not known there,"
            " and these stretches are not used."
        )
