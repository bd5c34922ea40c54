"""Files of WPILib's SysId, as it wrote them until 2023: JSON with rows of time, volts, position and velocity."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Log, Signal, Span
from simgap.recordings.importers.sysid_json import load, runs_of

FORMAT = "SysId JSON"
_PAUSE = 1.0  # s put between two runs on the common clock; any time above zero does
_FACTS: tuple[str, ...] = ("units", "unitsPerRotation", "test")
_QUANTITIES = {"voltage": "V", "position": None, "velocity": None}


def read(path: Path) -> Log:
    """Read a SysId file in its own numbers; each test, and each side of a drivetrain, is a run.

    Raises:
        InputError: when it is no SysId data.
    """
    content = load(path)
    runs = runs_of(content, path)
    spans, times, begin = [], [], 0.0
    for name, run in runs.items():
        time = begin + run.time - run.time[0]
        end = float(np.nanmax(time, initial=begin))
        spans.append(Span(name, begin, end))
        times.append(time)
        begin = end + _PAUSE
    clock = _joined(times)
    signals = {
        name: Signal(
            name,
            clock,
            _joined([getattr(run, name) for run in runs.values()]),
            unit,
            held=name == "voltage",
        )
        for name, unit in _QUANTITIES.items()
    }
    facts = {key: str(content[key]) for key in _FACTS if key in content}
    return Log(FORMAT, str(path), signals, tuple(spans), facts)


def _joined(parts: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    return np.ascontiguousarray(parts[0]) if len(parts) == 1 else np.concatenate(parts)
