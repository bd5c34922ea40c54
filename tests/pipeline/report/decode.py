"""Read back what `simgap.report.figure.encode` wrote, as the page's script does."""

import base64
from typing import Any

import numpy as np


def decode(coded: list[float | None] | dict[str, Any]) -> np.ndarray:
    """Return the numbers, shape (n,); NaN where there is a gap."""
    if isinstance(coded, list):
        return np.array([np.nan if value is None else value for value in coded])
    steps = np.frombuffer(base64.b64decode(coded["u2"]), dtype="<u2")
    return np.where(steps == 65535, np.nan, coded["low"] + coded["step"] * steps)
