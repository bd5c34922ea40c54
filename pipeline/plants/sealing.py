"""Sealing of a recording: it carries only the hash of its answer key."""

import hashlib
import json
from typing import Any

import pandas as pd

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
        source=source_of(key),
    )


def source_of(key: dict[str, Any]) -> str:
    """Return what a recording of a concealed plant says of its source: the hash of its answer key."""
    return f"the project's own concealed plant, answer key sha256:{key_hash(key)}"


def key_text(key: dict[str, Any]) -> str:
    """Return a key as it is written to its file."""
    return json.dumps(key, indent=2, sort_keys=True, ensure_ascii=False) + "\n"


def key_hash(key: dict[str, Any]) -> str:
    """Return the SHA-256 of a key's file."""
    return hashlib.sha256(key_text(key).encode()).hexdigest()
