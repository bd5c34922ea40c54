"""Faults of single rows: what a register, a sensor, a clock or a person does to a part of a recording.

They are mended or left out, and said.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from simgap.recordings.recording import Recording, recording_from_frame
from simgap.recordings.runs import by_run

Change = Callable[[np.ndarray], np.ndarray]
Rows = Callable[[pd.DataFrame], pd.DataFrame]


@dataclass(frozen=True)
class RowFault:
    """A way to spoil some rows of a column.

    Attributes:
        name: in the table.
        column: that is spoilt, or one that has to be there.
        change: of the column in one run.
        said: what has to stand in a warning of the cleaned recording, or as a reason among its changes.
        rows: of one run, where more than one column is concerned.
    """

    name: str
    column: str
    change: Change
    said: str
    rows: Rows | None = None

    def possible(self, recording: Recording) -> bool:
        """Whether a recording has the column, and something happens in it."""
        return self.column == "t" or (
            self.column in recording.channels and recording.frame[self.column].abs().max() > 0.0
        )

    def of(self, recording: Recording) -> Recording:
        """Return the spoilt recording, read as a file of it would be."""
        frame = pd.concat([self._spoilt(rows) for _, rows in by_run(recording.frame)], ignore_index=True)
        if self.column != "t":
            return replace(recording, frame=frame)
        sliding = recording.units.get("position") == "m"
        return recording_from_frame(frame, recording.kind, sliding=sliding)

    def _spoilt(self, run: pd.DataFrame) -> pd.DataFrame:
        if self.rows is not None:
            return self.rows(run)
        return run.assign(**{self.column: self.change(run[self.column].to_numpy(dtype=float))})


def overflowing(bits: int) -> Change:
    """Return a register of so many bits that holds six tenths of the values."""

    def change(values: np.ndarray) -> np.ndarray:
        quantum = 1.2 * np.nanmax(np.abs(values)) / 2**bits
        half = 2 ** (bits - 1)
        return ((np.round(values / quantum) + half) % 2**bits - half) * quantum

    return change


def sign_and_size(values: np.ndarray) -> np.ndarray:
    """Return numbers of 16 bits whose highest one is the sign; the sizes fill five sixths of the rest."""
    quantum = 1.2 * np.nanmax(np.abs(values)) / 2**15
    ticks = np.round(values / quantum)
    return np.where(ticks < 0, 2**15 - ticks, ticks) * quantum


def dead(values: np.ndarray) -> np.ndarray:
    """Return values of which a fifteenth stands still at the largest one."""
    result = values.copy()
    result[_fastest(values)] = values[_fastest(values)][0]
    return result


def zeros(values: np.ndarray) -> np.ndarray:
    """Return values of which a fifteenth, from the largest one on, is zero."""
    result = values.copy()
    result[_fastest(values)] = 0.0
    return result


def halved(values: np.ndarray) -> np.ndarray:
    """Return a speed of which every other count is missed in a fifteenth, from the largest one on."""
    result = values.copy()
    result[_fastest(values)] *= 0.5
    return result


def unchanged(values: np.ndarray) -> np.ndarray:
    return values


def _fastest(values: np.ndarray) -> slice:
    length = len(values) // 15
    first = min(int(np.nanargmax(np.abs(values))), len(values) - length)
    return slice(first, first + length)


def restarted(values: np.ndarray) -> np.ndarray:
    """Return times that begin anew in the middle."""
    middle = len(values) // 2
    return np.concatenate([values[:middle], values[middle:] - values[middle]])


def tumbling(run: pd.DataFrame) -> pd.DataFrame:
    """Return a flight that loses control in its last second: it turns over and over, and falls."""
    time = run["t"].to_numpy()
    late = np.maximum(time - (time[-1] - 1.0), 0.0)
    spinning, rate = late > 0.0, 25.0
    lost = run.copy()
    angle = 0.5 * rate * late
    for part, values in {"w": np.cos(angle), "x": np.sin(angle), "y": 0.0 * angle, "z": 0.0 * angle}.items():
        lost[f"attitude_{part}"] = np.where(spinning, values, run[f"attitude_{part}"])
    lost["body_rate_x"] = np.where(spinning, rate, run["body_rate_x"])
    lost["velocity_z"] = run["velocity_z"] - 9.81 * late
    lost["position_z"] = run["position_z"] - 0.5 * 9.81 * late**2
    return lost


def on_ground(run: pd.DataFrame) -> pd.DataFrame:
    """Return a flight that stands on the ground for two seconds before; the climb between is not recorded."""
    rest = _resting(run, 2.0).assign(position_z=run["position_z"].min(), specific_force_z=9.81)
    measured = [
        name for name in run if name.startswith(("position", "velocity", "body_rate", "specific_force"))
    ]
    rest[measured] += 1e-3 * np.random.default_rng(0).normal(size=(len(rest), len(measured)))
    rest[[f"attitude_{part}" for part in "wxyz"]] = [1.0, 0.0, 0.0, 0.0]
    return pd.concat([rest[run.columns].assign(t=rest["t"] - 1.0), run])


def standing(run: pd.DataFrame) -> pd.DataFrame:
    """Return a drive that stands for two seconds before: nothing is asked for, and nothing moves."""
    rest = _resting(run, 2.0)
    angles = [f"steer_angle_{module}" for module in "1234"]
    rest[angles] = run[angles].iloc[0].to_numpy()
    return pd.concat([rest[run.columns], run])


def _resting(run: pd.DataFrame, seconds: float) -> pd.DataFrame:
    """Return rows before a run in which all is zero, but for its place and its battery."""
    time = run["t"].to_numpy()
    step = float(np.median(np.diff(time)))
    before = time[0] - step * np.arange(round(seconds / step), 0, -1)
    rest = pd.DataFrame(0.0, index=range(len(before)), columns=run.columns.drop("run")).assign(t=before)
    kept = [name for name in run if name.startswith("position") or name == "battery_voltage"]
    rest[kept] = run[kept].iloc[0].to_numpy()
    return rest.assign(run=run["run"].iloc[0])


def _joint() -> Iterator[RowFault]:
    for bits in (12, 16):
        yield RowFault(f"velocity wraps at 2^{bits}", "velocity", overflowing(bits), "wraps at")
    yield RowFault("position wraps at 2^12", "position", overflowing(12), "wraps at")
    yield RowFault("velocity with a sign bit", "velocity", sign_and_size, "its sign in its highest bit")
    yield RowFault("velocity dead", "velocity", dead, "repeats one value")
    yield RowFault("velocity zero for a while", "velocity", zeros, "repeats one value")
    yield from _common()


def _common() -> Iterator[RowFault]:
    yield RowFault("battery at 0 V", "battery_voltage", zeros, "which no battery does")
    yield RowFault("clock starts anew", "t", restarted, "starts anew")


def _swerve() -> Iterator[RowFault]:
    yield RowFault("steer velocity wraps at 2^12", "steer_velocity_2", overflowing(12), "wraps at")
    yield RowFault("steer velocity with a sign bit", "steer_velocity_2", sign_and_size, "in its highest bit")
    yield RowFault("steer velocity dead", "steer_velocity_2", dead, "repeats one value")
    yield RowFault("steer velocity zero for a while", "steer_velocity_2", zeros, "repeats one value")
    yield from _counted("drive velocity", "drive_velocity_3")
    yield from _common()
    yield RowFault("stands before it drives", "steer_angle_1", unchanged, "no motion", standing)


def _quadrotor() -> Iterator[RowFault]:
    yield RowFault("velocity wraps at 2^12", "velocity_x", overflowing(12), "wraps at")
    yield RowFault("velocity dead", "velocity_x", dead, "repeats one value")
    yield RowFault("velocity zero for a while", "velocity_x", zeros, "repeats one value")
    yield from _counted("motor speed", "motor_speed_3")
    yield from _common()
    yield RowFault("loses control", "position_z", unchanged, "lost control", tumbling)
    yield RowFault("on the ground before take-off", "position_z", unchanged, "not flying", on_ground)


def _counted(name: str, column: str) -> Iterator[RowFault]:
    yield RowFault(f"{name} counts half", column, halved, "falls to half")
    yield RowFault(f"{name} zero for a while", column, zeros, "falls to zero")
    yield RowFault(f"{name} dead", column, dead, "repeats one value")


ROW_FAULTS: dict[str, tuple[RowFault, ...]] = {
    "joint": tuple(_joint()),
    "swerve": tuple(_swerve()),
    "quadrotor": tuple(_quadrotor()),
}
"""The faults of rows of each kind."""
