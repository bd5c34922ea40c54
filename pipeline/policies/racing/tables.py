"""Laps and flights as tables."""

import numpy as np
import pandas as pd

from simgap.policies.racing.flying import PARTS
from simgap.policies.racing.laps import Laps

_COLUMNS = {"position": "xyz", "attitude": "wxyz", "velocity": "xyz", "body_rate": "xyz"}


def laps_table(laps: Laps) -> pd.DataFrame:
    """Return a row per machine and lap: `machine`, `lap`, `time` s (missing where it was not completed)."""
    machines, count = laps.times.shape
    return pd.DataFrame(
        {
            "machine": np.repeat(np.arange(machines), count),
            "lap": np.tile(np.arange(1, count + 1), machines),
            "time": laps.times.flatten().cpu().numpy(),
        }
    )


def flight_table(laps: Laps, period: float) -> pd.DataFrame:
    """Return the flight of the fastest machine, with the columns of a recording (docs/contract.md).

    Args:
        laps: flown.
        period: between two states, s.
    """
    states = laps.states[:, laps.fastest].cpu().numpy()
    states = states[np.isfinite(states).all(axis=1)]
    columns = {
        f"{name}_{axis}": states[:, PARTS[name].start + number]
        for name, axes in _COLUMNS.items()
        for number, axis in enumerate(axes)
    }
    return pd.DataFrame({"run": "fastest", "t": np.arange(len(states)) * period, **columns})
