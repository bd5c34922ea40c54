"""Sealing of a recording: it carries only the hash of its answer key."""

from typing import Any

import pandas as pd

from simgap.plants.fly import key_hash
from simgap.recordings.contract import channel_units
from simgap.recordings.recording import Recording


def sealed(frame: pd.DataFrame, kind: str, key: dict[str, Any], sliding: bool = False) -> Recording:
    """Return the recording of a concealed plant.

    Args:
        frame: `run`, `t` and channels of the contract.
        kind: of the platform.
        key: whose hash the recording's source names.
        sliding: whether a joint's position is in m.
    """
    units = channel_units(kind, sliding)
    return Recording(
        frame=frame,
        kind=kind,
        units={column: units[column] for column in frame.columns if column in units},
        source=f"the project's own concealed plant, answer key sha256:{key_hash(key)}",
    )
