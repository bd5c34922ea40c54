"""Small recordings that obey the contract and the kinematics, for every kind."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from simgap.recordings.contract import COLUMNS, REQUIRED

Frames = Callable[..., pd.DataFrame]


def _joint(time: np.ndarray, phase: float) -> dict[str, np.ndarray]:
    return {
        "position": np.sin(3 * time + phase),
        "velocity": 3 * np.cos(3 * time + phase),
        "voltage": 2 * np.cos(3 * time),
    }


def _quadrotor(time: np.ndarray, phase: float) -> dict[str, np.ndarray]:
    """Turn to and fro about a slanted axis, while gliding along x, y and z."""
    axis = np.array([2.0, -2.0, 1.0]) / 3
    angle, rate = 0.5 * np.sin(2 * time + phase), np.cos(2 * time + phase)
    channels = {"attitude_w": np.cos(angle / 2)}
    for index, name in enumerate("xyz"):
        channels[f"attitude_{name}"] = axis[index] * np.sin(angle / 2)
        channels[f"body_rate_{name}"] = axis[index] * rate
    for index, axis in enumerate("xyz"):
        channels[f"position_{axis}"] = np.sin(time + index)
        channels[f"velocity_{axis}"] = np.cos(time + index)
    channels |= {f"motor_speed_{rotor}": 2000 + 10 * np.sin(time) for rotor in "1234"}
    return channels


def _swerve(time: np.ndarray, phase: float) -> dict[str, np.ndarray]:
    channels = {column: np.sin(time + phase) for column in REQUIRED["swerve"]}
    for module in "1234":
        channels[f"steer_angle_{module}"] = np.sin(2 * time + phase)
        channels[f"steer_velocity_{module}"] = 2 * np.cos(2 * time + phase)
    return channels


_KINDS = {"joint": _joint, "quadrotor": _quadrotor, "swerve": _swerve}


@pytest.fixture(scope="session")
def frames() -> Frames:
    """Return a function that makes a frame of a kind; columns in the order of the contract."""

    def make(kind: str = "joint", runs: int = 2, samples: int = 200, step: float = 0.01) -> pd.DataFrame:
        time = np.arange(samples) * step
        parts = []
        for index in range(runs):
            channels = _KINDS[kind](time, float(index))
            ordered = {column: channels[column] for column in COLUMNS[kind] if column in channels}
            parts.append(pd.DataFrame({"run": f"run{index}", "t": time} | ordered))
        return pd.concat(parts, ignore_index=True)

    return make
