"""Flights of a Crazyflie that logged accelerometer, gyroscope and motor commands, but no position."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.dead_reckoning import dead_reckoning
from simgap.recordings.importers.columns import Column, check_options, take, vector
from simgap.recordings.importers.event_log import read_event_log
from simgap.recordings.recording import Recording, recording_from_frame

_FULL_COMMAND = 65535  # of the 16-bit pulse-width command
_GRAVITY = 9.81
_MEASURED = (
    {"t": Column("timestamp", "us")}
    | vector("specific_force", (f"acc.{axis}" for axis in "xyz"), "g")
    | vector("body_rate", (f"gyro.{axis}" for axis in "xyz"), "deg/s")
    | vector("motor_command", (f"motor.m{rotor}" for rotor in "1234"), "1", "1234", 1 / _FULL_COMMAND)
)
_STATE_AXES = {"position": "xyz", "velocity": "xyz", "attitude": "wxyz"}


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read flights; one run per time window of the log.

    Attitude, velocity and position were not recorded. They are dead-reckoned from gyroscope and accelerometer, within
    each window for itself; the gyroscope's bias is its mean before the motors start.

    Args:
        paths: binary logs.
        options: `flights`: name of a log to its windows [from, to], s of the log's clock.

    Raises:
        InputError: when a file or a window cannot be used.
    """
    check_options(options, ("flights",), "crazyflie_log")
    windows = options.get("flights") or {}
    frames = [frame for path in paths for frame in _flights(path, windows.get(path.name))]
    remark = (
        "Position, velocity and attitude were not recorded; they are dead-reckoned from gyroscope and accelerometer "
        "and drift, so effects of speed or height cannot be judged."
    )
    return recording_from_frame(pd.concat(frames, ignore_index=True), "quadrotor", warnings=[remark])


def _flights(path: Path, windows: Any) -> Iterator[pd.DataFrame]:
    log = read_event_log(path)
    frame = take(log, _MEASURED, "quadrotor", pd.Series([path.name] * len(log)), str(path))
    rates = [f"body_rate_{axis}" for axis in "xyz"]
    turning = (frame[[f"motor_command_{rotor}" for rotor in "1234"]] > 0).any(axis=1).to_numpy()
    resting = frame.loc[: int(np.argmax(turning)) - 1, rates] if turning.any() else frame[rates]
    if resting.empty:
        raise InputError("the motors turn from the first sample", str(path), "record some rest before")
    frame[rates] -= resting.mean()
    where = f"dataset.options.flights.{path.name}"
    for number, (first, last) in enumerate(_checked(windows, where), start=1):
        flight = frame[frame["t"].between(first, last)]
        if len(flight) < 2:
            raise InputError(f"[{first:g}, {last:g}] holds no samples", where, "correct the window")
        name = path.name if len(windows) == 1 else f"{path.name}-{number}"
        yield _with_state(flight.assign(run=name))


def _checked(windows: Any, where: str) -> list[tuple[float, float]]:
    try:
        return [(float(first), float(last)) for first, last in windows]
    except (TypeError, ValueError):
        raise InputError(f"{windows!r} names no windows", where, "give a list of [from, to], s") from None


def _with_state(flight: pd.DataFrame) -> pd.DataFrame:
    body_rate, specific_force = (
        flight[[f"{name}_{axis}" for axis in "xyz"]].to_numpy() for name in ("body_rate", "specific_force")
    )
    attitude, velocity, position = dead_reckoning(flight["t"].to_numpy(), body_rate, specific_force, _GRAVITY)
    state = {"position": position, "velocity": velocity, "attitude": attitude}
    columns = {
        f"{name}_{axis}": state[name][:, place]
        for name, axes in _STATE_AXES.items()
        for place, axis in enumerate(axes)
    }
    return flight.assign(**columns)
