"""Flights written as blackbox logs, as Betaflight would have logged them."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from tests.pipeline.logs.readers import blackbox_writer as writer
from tests.pipeline.logs.readers.blackbox_writer import END, Field, frames, header

FACTS = {
    "Firmware revision": "Betaflight 4.4.2 (abc) STM32F745",
    "I interval": 64,
    "P interval": 8,
    "gyro_scale": "0x3f800000",
    "acc_1G": 2048,
    "minthrottle": 1070,
    "vbatref": 1650,
    "motorOutput": "158,2047",
    "motor_poles": 14,
}
CLOCK = (
    Field("loopIteration", False, (0, writer.UNSIGNED), (6, writer.NULL)),
    Field("time", False, (0, writer.UNSIGNED), (2, writer.SIGNED)),
)
SIGNS = ((-1, -1), (1, -1), (-1, 1), (1, 1))
"""Of x and y of the motors, in the order of Betaflight: rear right, front right, rear left, front left."""


def order_of(positions: Sequence[Sequence[float]]) -> list[int]:
    """Return which rotor of a platform each motor of Betaflight is."""
    signs = [(int(np.sign(x)), int(np.sign(y))) for x, y, _ in positions]
    return [signs.index(sign) for sign in SIGNS]


def blackbox_of(frame: pd.DataFrame, order: Sequence[int] = range(4), facts: dict | None = None) -> bytes:
    """Return the file of a flash memory that holds each run as a log.

    Args:
        frame: a recording in the contract's columns: rates, specific force, motor commands, battery.
        order: which rotor of the recording each motor is.
        facts: further lines of the header.
    """
    return b"".join(_log(run, order, FACTS | (facts or {})) for _, run in frame.groupby("run", sort=False))


def _log(run: pd.DataFrame, order: Sequence[int], facts: dict) -> bytes:
    command = run[[f"motor_command_{rotor + 1}" for rotor in order]].to_numpy()
    parts = {
        "loopIteration": 8 * np.arange(len(run)),
        "time": (run["t"] - run["t"].iloc[0]).to_numpy() * 1e6 + 3e6,
        "rcCommand[3]": 1000 + 1000 * command.mean(axis=1),
        "vbatLatest": 100 * run["battery_voltage"],
        **{f"gyroADC[{n}]": np.degrees(run[f"body_rate_{axis}"]) for n, axis in enumerate("xyz")},
        **{f"accSmooth[{n}]": 2048 / 9.80665 * run[f"specific_force_{axis}"] for n, axis in enumerate("xyz")},
        **{f"motor[{n}]": 48 + 1999 * command[:, n] for n in range(4)},
    }
    if "motor_speed_1" in run:
        turns = run[[f"motor_speed_{rotor + 1}" for rotor in order]].to_numpy() * 60 / (2 * np.pi)
        parts |= {f"eRPM[{n}]": turns[:, n] * 7 / 100 for n in range(4)}
    fields = tuple(Field(name, not name.startswith("motor["), between=(3, writer.SIGNED)) for name in parts)
    fields = (*CLOCK, *fields[2:])
    rows = np.rint(np.column_stack(list(parts.values()))).astype(np.int64)
    return header(fields, facts) + b"".join(frames(fields, rows, facts, every=8)) + END
