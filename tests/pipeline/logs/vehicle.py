"""A simulated flight as a flight controller would log it: north, east, down; forward, right, down; its motors' order.

And what holds for every recording of a flight, whoever logged it: the columns are one motion under gravity.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from simgap.plants.case import PlantCase, Sensors
from simgap.plants.fly import fly
from simgap.platforms import platform_from_config

ROOT = Path(__file__).parents[3]
START = 5_000_000  # µs, when the log begins
GROUND = 1.0  # s before take-off and after landing
ORDER = (1, 3, 4, 2)
"""Motors 1 to 4 of PX4 and ArduPilot (front right, rear left, front left, rear right) by the numbers of the racer."""
SIGNS = {"x": 1, "y": -1, "z": -1, "w": 1}


@cache
def flight() -> pd.DataFrame:
    """Return a flight of the racer without noise, its motors in the order of a flight controller."""
    racer = platform_from_config(yaml.safe_load((ROOT / "conf/platform/racer.yaml").read_text()))
    case = PlantCase(runs=1, duration=3.0, sensors=Sensors(scale=0.0))
    frame = fly(case, racer, seed=3)[0].frame
    return frame.assign(
        **{
            f"{group}_{number}": frame[f"{group}_{own}"]
            for group in ("motor_speed", "motor_command")
            for number, own in enumerate(ORDER, 1)
        }
    )


def padded(name: str, ground: float) -> np.ndarray:
    """Return a column with the time on the ground before and after the flight."""
    values = flight()[name].to_numpy()
    still = round(GROUND * 100)
    return np.concatenate([np.full(still, ground), values, np.full(still, ground)])


def stamps() -> np.ndarray:
    """Return the times of the samples, µs."""
    return START + 10_000 * np.arange(len(padded("t", 0.0)))


def ned(name: str) -> np.ndarray:
    """Return a column of a vector or quaternion in north, east, down or forward, right, down."""
    ground = {"attitude_w": 1.0, "specific_force_z": 9.81}
    values = padded(name, ground.get(name, low() if name == "position_z" else 0.0))
    axis = name[-1]
    if name.startswith("attitude"):
        return values if axis in "wx" else -values
    return SIGNS[axis] * values


def low() -> float:
    """Return the height of the ground, m: a metre below the flight."""
    return float(flight()["position_z"].min()) - 1.0


def airborne() -> np.ndarray:
    """Return whether the vehicle says that it flies: from half a second before it is off the ground."""
    seconds = (stamps() - START) / 1e6
    return (seconds > GROUND / 2) & (seconds < seconds[-1] - GROUND / 2)


def assert_one_motion(frame: pd.DataFrame) -> None:
    """The velocity is the derivative of the position, and so on; each with slope 1, which no wrong sign gives."""
    t = frame["t"].to_numpy()
    position, velocity = columns(frame, "position"), columns(frame, "velocity")
    rate, force, q = columns(frame, "body_rate"), columns(frame, "specific_force"), columns(frame, "attitude")
    for axis in range(3):
        assert _slope(velocity[:, axis], np.gradient(position[:, axis], t)) == pytest.approx(1.0, abs=0.05)
        assert _slope(turned(q, force)[:, axis], np.gradient(velocity[:, axis], t)) == pytest.approx(
            1.0, abs=0.2
        )
        assert _slope(rate[:, axis], _rates(q, t)[:, axis]) == pytest.approx(1.0, abs=0.1)
    assert abs(np.median(force[:, 2]) - 9.81) < 1.0  # thrust is up


def assert_motors_turn_it(frame: pd.DataFrame, positions: np.ndarray, directions: list[int]) -> None:
    """More thrust on the left rolls to the right, in the rear pitches down, of clockwise rotors yaws to the left."""
    squares = frame[[f"motor_command_{rotor}" for rotor in range(1, 5)]].to_numpy() ** 2
    t = frame["t"].to_numpy()
    turning = np.gradient(columns(frame, "body_rate"), t, axis=0)
    for axis, torque in enumerate(
        (squares @ positions[:, 1], -squares @ positions[:, 0], squares @ directions)
    ):
        assert np.corrcoef(torque, turning[:, axis])[0, 1] > 0.5


def columns(frame: pd.DataFrame, name: str) -> np.ndarray:
    """Return the columns of a vector or an attitude, (n, 3) or (n, 4)."""
    return frame[[f"{name}_{axis}" for axis in ("wxyz" if name == "attitude" else "xyz")]].to_numpy()


def _slope(given: np.ndarray, derived: np.ndarray) -> float:
    """Return the slope of what is recorded over what it should be."""
    inner = slice(2, -2)
    a, b = given[inner] - given[inner].mean(), derived[inner] - derived[inner].mean()
    return float(a @ b / (b @ b))


def turned(q: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return vectors of the body in the world."""
    w, u = q[:, :1], q[:, 1:]
    return vector + 2 * w * np.cross(u, vector) + 2 * np.cross(u, np.cross(u, vector))


def _rates(q: np.ndarray, t: np.ndarray) -> np.ndarray:
    dq = np.gradient(q, t, axis=0)
    return 2 * (q[:, :1] * dq[:, 1:] - dq[:, :1] * q[:, 1:] - np.cross(q[:, 1:], dq[:, 1:]))
