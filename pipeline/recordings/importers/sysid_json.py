"""WPILib SysId data: slow ramps and voltage steps of an axis or of both sides of a drivetrain, as JSON."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.importers.columns import check_options
from simgap.recordings.recording import Recording, recording_from_frame

_TESTS = ("slow-forward", "slow-backward", "fast-forward", "fast-backward")
_SIDE_COLUMNS = {
    "left": (1, 3, 5),
    "right": (2, 4, 6),
}  # columns of voltage, position, velocity; 0 is time in s
_AXIS = {"": (1, 2, 3)}
_UNITS = {
    "Meters": ("m", 1.0),
    "Feet": ("m", 0.3048),
    "Inches": ("m", 0.0254),
    "Radians": ("rad", 1.0),
    "Degrees": ("rad", math.pi / 180),
    "Rotations": ("rad", 2 * math.pi),
}


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read SysId files as a joint; one run per test, and per side of a drivetrain.

    SysId stores rotations and, beside them, of which `units` one rotation gives `unitsPerRotation`; some
    robots store positions or velocities in those units already, which the options say.

    Args:
        paths: JSON files; with several, the file's name precedes that of the run.
        options: `position` and `velocity`: "rotations" or "units", what the file's numbers are in.

    Raises:
        InputError: when a file is not SysId data.
    """
    check_options(options, ("position", "velocity"), "sysid_json")
    frames, lengths = [], set()
    for path in paths:
        content = _load(path)
        unit, factor = _unit(content, path)
        lengths.add(unit)
        scales = [_scale(options, channel, content, factor, path) for channel in ("position", "velocity")]
        prefix = f"{path.stem}-" if len(paths) > 1 else ""
        frames += [frame.assign(run=prefix + frame["run"]) for frame in _frames(content, scales, path)]
    if len(lengths) > 1:
        raise InputError(
            "some files are in lengths, others in angles", str(paths[0]), "import them one by one"
        )
    return recording_from_frame(pd.concat(frames, ignore_index=True), "joint", sliding="m" in lengths)


def _load(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be read as JSON ({error})", str(path), "give the file that SysId saved"
        ) from None
    if not isinstance(content, dict) or not any(test in content for test in _TESTS):
        raise InputError("holds no SysId test", str(path), f"one of {', '.join(_TESTS)} is needed")
    return content


def _unit(content: Mapping[str, Any], path: Path) -> tuple[str, float]:
    if content.get("units") not in _UNITS:
        raise InputError(
            f"unknown units {content.get('units')!r}", str(path), f"use one of {', '.join(_UNITS)}"
        )
    return _UNITS[content["units"]]


def _scale(
    options: Mapping[str, Any], channel: str, content: Mapping[str, Any], factor: float, path: Path
) -> float:
    """Return what one of the file's numbers is, in m or rad (per s)."""
    stored = options.get(channel, "rotations")
    if stored not in ("rotations", "units"):
        raise InputError(f"{stored!r} is neither", f"dataset.options.{channel}", "say rotations or units")
    if stored == "units":
        return factor
    per_rotation = content.get("unitsPerRotation")
    if not isinstance(per_rotation, int | float) or per_rotation <= 0:
        raise InputError("is missing or not positive", f"{path}, unitsPerRotation", "correct the file")
    return factor * float(per_rotation)


def _frames(content: Mapping[str, Any], scales: Sequence[float], path: Path) -> Iterator[pd.DataFrame]:
    for test in _TESTS:
        if not content.get(test):
            continue
        try:
            rows = np.array(content[test], dtype=float)
        except (TypeError, ValueError):
            raise InputError(
                "holds rows that are not numbers", f"{path}, {test}", "record the test again"
            ) from None
        if rows.ndim != 2 or rows.shape[1] not in (4, 9):
            raise InputError("rows have neither 4 nor 9 numbers", f"{path}, {test}", "record the test again")
        for side, (voltage, position, velocity) in (_SIDE_COLUMNS if rows.shape[1] == 9 else _AXIS).items():
            yield pd.DataFrame(
                {
                    "run": f"{test}-{side}" if side else test,
                    "t": rows[:, 0],
                    "position": rows[:, position] * scales[0],
                    "velocity": rows[:, velocity] * scales[1],
                    "voltage": rows[:, voltage],
                }
            )
