"""WPILib SysId data: slow ramps and voltage steps of an axis or of both sides of a drivetrain, as JSON."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.importers.columns import check_options
from simgap.recordings.importers.sysid_alike import content_of_rows
from simgap.recordings.importers.sysid_rows import content_by_arrow
from simgap.recordings.importers.sysid_units import SORTS, UNITS, Samples, described, readings_of, scale_of
from simgap.recordings.recording import Recording, recording_from_frame

TESTS = ("slow-forward", "slow-backward", "fast-forward", "fast-backward")
_SIDE_COLUMNS = {
    "left": (1, 3, 5),
    "right": (2, 4, 6),
}  # columns of voltage, position, velocity; 0 is time in s
_AXIS = {"": (1, 2, 3)}


def read(paths: Sequence[Path], options: Mapping[str, Any]) -> Recording:
    """Read SysId files as a joint; one run per test, and per side of a drivetrain.

    SysId means rotations and, beside them, of which `units` one rotation gives `unitsPerRotation`; some robots write
    positions or velocities in those units already. The numbers say which, or the options.

    Args:
        paths: JSON files; with several, the file's name precedes that of the run.
        options: `position` and `velocity`: "rotations" or "units", what the file's numbers are in.

    Raises:
        InputError: when a file is not SysId data, or does not say what its numbers are.
    """
    check_options(options, ("position", "velocity"), "sysid_json")
    frames, lengths = [], set()
    for path in paths:
        content = load(path)
        unit, factor = UNITS[content["units"]]
        lengths.add(unit)
        runs = runs_of(content, path)
        position, velocity = _sorts(options, content, runs, path)
        per_rotation = float(content["unitsPerRotation"])
        prefix = f"{path.stem}-" if len(paths) > 1 else ""
        frames += [
            pd.DataFrame(
                {
                    "run": prefix + name,
                    "t": run.time,
                    "position": run.position * scale_of(position, factor, per_rotation),
                    "velocity": run.velocity * scale_of(velocity, factor, per_rotation),
                    "voltage": run.voltage,
                }
            )
            for name, run in runs.items()
        ]
    if len(lengths) > 1:
        raise InputError(
            "some files are in lengths, others in angles", str(paths[0]), "import them one by one"
        )
    return recording_from_frame(pd.concat(frames, ignore_index=True), "joint", sliding="m" in lengths)


def load(path: Path) -> dict[str, Any]:
    """Return the content of a SysId file, with its units checked.

    Raises:
        InputError: when it is no JSON, or no SysId data.
    """
    try:
        content = content_of_rows(path) or _parsed(path.read_bytes())
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(
            f"cannot be read as JSON ({error})", str(path), "give the file that SysId saved"
        ) from None
    if not isinstance(content, dict) or not any(_is_there(content.get(test)) for test in TESTS):
        raise InputError("holds no SysId test", str(path), f"one of {', '.join(TESTS)} is needed")
    if not isinstance(content.get("units"), str) or content["units"] not in UNITS:
        raise InputError(
            f"unknown units {content.get('units')!r}", str(path), f"use one of {', '.join(UNITS)}"
        )
    per_rotation = content.get("unitsPerRotation")
    if (
        isinstance(per_rotation, bool)
        or not isinstance(per_rotation, int | float)
        or not 0 < per_rotation < 1e6
    ):
        raise InputError("is missing or not positive", f"{path}, unitsPerRotation", "correct the file")
    return content


def _parsed(text: bytes) -> Any:
    return content_by_arrow(text) or json.loads(text.decode())


def _is_there(rows: Any) -> bool:
    """Whether a test has rows: a list, or an array that Arrow read."""
    return len(rows) > 0 if isinstance(rows, np.ndarray) else bool(rows)


def runs_of(content: Mapping[str, Any], path: Path) -> dict[str, Samples]:
    """Return the tests of a file in its own numbers, by `TEST`, or `TEST-left` and `TEST-right` of a drivetrain.

    Raises:
        InputError: when its rows are not what SysId writes.
    """
    runs = {}
    for test in TESTS:
        if not _is_there(content.get(test)):
            continue
        try:
            rows = np.asarray(content[test], dtype=float)
        except (TypeError, ValueError, OverflowError):
            raise InputError(
                "holds rows that are not numbers", f"{path}, {test}", "record the test again"
            ) from None
        if rows.ndim != 2 or rows.shape[1] not in (4, 9):
            raise InputError("rows have neither 4 nor 9 numbers", f"{path}, {test}", "record the test again")
        for side, (voltage, position, velocity) in (_SIDE_COLUMNS if rows.shape[1] == 9 else _AXIS).items():
            name = f"{test}-{side}" if side else test
            runs[name] = Samples(rows[:, 0], rows[:, voltage], rows[:, position], rows[:, velocity])
    return runs


def _sorts(
    options: Mapping[str, Any], content: Mapping[str, Any], runs: Mapping[str, Samples], path: Path
) -> tuple[str, str]:
    """Return what the positions and the velocities are in: as the options say, else as the numbers say."""
    for channel in ("position", "velocity"):
        if options.get(channel, SORTS[0]) not in SORTS:
            raise InputError(
                f"{options[channel]!r} is neither", f"dataset.options.{channel}", "say rotations or units"
            )
    if "position" in options and "velocity" in options:
        return str(options["position"]), str(options["velocity"])
    units, per_rotation = content["units"], float(content["unitsPerRotation"])
    found = [
        reading
        for reading in readings_of(list(runs.values()), units, per_rotation, str(path))
        if options.get("position", reading.position) == reading.position
        and options.get("velocity", reading.velocity) == reading.velocity
    ]
    if len(found) != 1:
        raise InputError(
            f"its numbers may be {described(found, units)}" if found else "its numbers contradict the option",
            str(path),
            "give dataset.options.position and dataset.options.velocity: rotations or units",
        )
    return found[0].position, found[0].velocity
