"""Recordings of known motion, clean until a test spoils them."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from simgap.recordings import Recording
from simgap.recordings.cleaning.table import ChannelTable
from simgap.recordings.cleaning.work import RunUnderCleaning
from simgap.recordings.contract import COLUMNS, channel_units, needed_channels

STEP = 0.01
_FREQUENCIES = np.array([1.3, 2.1, 3.4, 4.7, 6.2, 7.9])


def recording_of(frame: pd.DataFrame, kind: str) -> Recording:
    """Return a recording of a frame with `run`, `t` and channels."""
    units = channel_units(kind)
    return Recording(frame=frame, kind=kind, units={c: units[c] for c in frame if c in units})


def run_of(frame: pd.DataFrame, kind: str) -> RunUnderCleaning:
    """Return the one run of a frame as the steps of cleaning take it."""
    columns = [column for column in frame if column not in ("run", "t")]
    time = frame["t"].to_numpy(copy=True)
    return RunUnderCleaning(
        name="one",
        kind=kind,
        time=time,
        columns=columns,
        table=ChannelTable.of(frame, columns),
        stretch=np.zeros(len(time), dtype=np.int64),
        needed=needed_channels(kind, set(columns)),
        time_step=float(np.median(np.diff(time))),
    )


def flight_frame(
    seconds: float = 12.0, offset: float = 0.0, seed: int = 0, noise: float = 1.0, run: str = "one"
) -> pd.DataFrame:
    """Return a flight whose state is late by `offset` s with respect to the motors.

    Squared rotor speeds are sums of sines; thrust and the angular acceleration about roll and pitch are
    linear in them, so that the state at any other time is known exactly.
    """
    random = np.random.default_rng(seed)
    time = np.arange(round(seconds / STEP)) * STEP
    amplitude, phase = random.uniform(0.5, 1.0, (2, 4, 6))
    phase = 2 * np.pi * phase

    def squares(at: np.ndarray) -> np.ndarray:
        return 3.2 + 0.06 * (amplitude * np.sin(2 * np.pi * _FREQUENCIES * at[:, None, None] + phase)).sum(2)

    def integrated(at: np.ndarray) -> np.ndarray:
        angle = 2 * np.pi * _FREQUENCIES * at[:, None, None] + phase
        return 0.06 * (-amplitude * np.cos(angle) / (2 * np.pi * _FREQUENCIES)).sum(2)

    late = time - offset
    lever = np.array([[-1, -1, 1, 1], [-1, 1, 1, -1], [0.1, -0.1, 0.1, -0.1]])
    angle = 0.3 * np.sin(1.7 * late)
    channels: dict[str, np.ndarray] = {}
    for index, axis in enumerate("xyz"):
        height = 1.5 if axis == "z" else 0.0
        channels[f"position_{axis}"] = np.sin(late + index) + height
        channels[f"velocity_{axis}"] = np.cos(late + index)
        channels[f"body_rate_{axis}"] = 30 * integrated(late) @ lever[index]
        channels[f"attitude_{axis}"] = np.sin(angle / 2) * [0.6, 0.0, 0.8][index]
        channels[f"specific_force_{axis}"] = (
            0.77 * squares(late).sum(1) if axis == "z" else 0.2 * np.sin(late)
        )
    channels["attitude_w"] = np.cos(angle / 2)
    for rotor in range(4):
        channels[f"motor_speed_{rotor + 1}"] = 1e3 * np.sqrt(squares(time)[:, rotor])
    size = {"position": 1e-4, "velocity": 1e-3, "body_rate": 5e-3, "specific_force": 5e-2, "motor_speed": 3.0}
    for column, values in channels.items():
        values += noise * size.get(column.rpartition("_")[0], 0.0) * random.standard_normal(len(time))
    ordered = {column: channels[column] for column in COLUMNS["quadrotor"] if column in channels}
    return pd.DataFrame({"run": run, "t": time} | ordered)


def joint_frame(seconds: float = 6.0, seed: int = 0, run: str = "one") -> pd.DataFrame:
    """Return a joint that swings under a sine of voltage, measured with a little noise."""
    random = np.random.default_rng(seed)
    time = np.arange(round(seconds / STEP)) * STEP
    return pd.DataFrame(
        {
            "run": run,
            "t": time,
            "position": np.sin(3 * time) + 1e-4 * random.standard_normal(len(time)),
            "velocity": 3 * np.cos(3 * time) + 1e-3 * random.standard_normal(len(time)),
            "voltage": 4 * np.sin(3 * time + 1.0),
        }
    )


@pytest.fixture
def flight() -> Callable[..., pd.DataFrame]:
    return flight_frame


@pytest.fixture
def joint() -> Callable[..., pd.DataFrame]:
    return joint_frame


@pytest.fixture
def as_run() -> Callable[[pd.DataFrame, str], RunUnderCleaning]:
    return run_of


@pytest.fixture
def as_recording() -> Callable[[pd.DataFrame, str], Recording]:
    return recording_of
