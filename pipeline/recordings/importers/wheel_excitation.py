"""Excitation of an omnidirectional robot's four wheels: encoder counts and duty cycles as text.

Format of `plant_excitation` in RoboJackets/robocup-firmware-data.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.importers.columns import check_options
from simgap.recordings.recording import Recording, recording_from_frame

_WHEELS = 4
_NUMBERS_PER_ROW = 10  # of a row: four encoders, four duty cycles, the clock's ticks, the gyroscope
_TICK_DURATION = 256 / 18.432e6  # s
_COUNT = 2 * math.pi / (3 * 2048)  # rad of a wheel
_FULL_DUTY = 512
_SUPPLY = 19.0  # V, "average" as the authors say; it was not recorded


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read drives as joints; one run per wheel of each file.

    A row holds the counts and the clock's ticks since the row before, and the duty cycle that was set then: it acts
    until the next row. The velocity is the change of the counted angle over a row on either side, so that it belongs
    to the same instant as the angle. The gyroscope's numbers are unusable and left out.

    The authors convert duty cycles by 19 V / 1024, which makes the back-EMF half of what the motor's data sheet says;
    with 19 V / 512, full duty being 512, the two agree.

    Args:
        paths: text files.
        options: none.

    Raises:
        InputError: when a file is not of this format.
    """
    check_options(options, (), "wheel_excitation")
    frames = [frame for path in paths for frame in _frames(_rows(path), path.stem)]
    remark = f"The supply was not recorded; voltages are duty cycles of {_SUPPLY:g} V."
    return recording_from_frame(pd.concat(frames, ignore_index=True), "joint", warnings=[remark])


def _rows(path: Path) -> np.ndarray:
    """Return the numbers of a file, (rows, 10)."""
    try:
        lines = path.read_text(encoding="ascii").splitlines()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read as text ({error})", str(path), "give another file") from None
    rows = []
    for number, line in enumerate(lines, start=1):
        try:
            values = [float(entry) for entry in line.split(",")]
        except ValueError:
            values = []
        if len(values) != _NUMBERS_PER_ROW or values[2 * _WHEELS] <= 0:
            raise InputError(
                f"is not {_NUMBERS_PER_ROW} numbers with a positive time",
                f"{path}, row {number}",
                "leave the row's file out",
            )
        rows.append(values)
    if len(rows) < 3:
        raise InputError("has fewer than three rows", str(path), "give another file")
    return np.array(rows)


def _frames(rows: np.ndarray, name: str) -> Iterator[pd.DataFrame]:
    time = np.cumsum(rows[:, 2 * _WHEELS]) * _TICK_DURATION
    for wheel in range(_WHEELS):
        angle = np.cumsum(rows[:, wheel]) * _COUNT
        yield pd.DataFrame(
            {
                "run": f"{name}-wheel{wheel + 1}",
                "t": time,
                "position": angle,
                "velocity": np.gradient(angle, time),
                "voltage": rows[:, _WHEELS + wheel] * (_SUPPLY / _FULL_DUTY),
            }
        )
