"""Whether a recording tells how large a named effect is, beside showing that it is there."""

import math
from collections.abc import Mapping
from typing import Any

UNTOLD = "The recording does not tell its size: the error is as large as the value."
"""The statement of an effect whose size is not told."""


def is_told(effect: Mapping[str, Any]) -> bool:
    """Whether a parameter of an effect is larger than its standard error, and as far from doing nothing.

    Args:
        effect: an entry of `effects` of docs/contract.md: its name and its parameters, of which one may lack an error.
    """
    neutral = 1.0 if str(effect["name"]).endswith("_error") else 0.0
    entries = [(entry.get("value"), entry.get("std")) for entry in effect["parameters"].values()]
    return not entries or any(_beyond(value, std, neutral) for value, std in entries)


def _beyond(value: float | None, std: float | None, neutral: float) -> bool:
    if value is None or std is None or not math.isfinite(std):
        return value is not None
    return min(abs(value), abs(value - neutral)) > std
