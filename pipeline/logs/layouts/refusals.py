"""Why a log of a flight controller is no recording of physics: one line each, with what to do."""

from collections.abc import Mapping

import numpy as np

from simgap.logs.layouts.rates import SLOWEST
from simgap.logs.log import Signal


def wrong_kind(kind: str | None) -> str:
    """Return what to say of a platform that does not fly; empty for a quadrotor.

    Args:
        kind: of the platform; None where it is not known.
    """
    return "" if kind in (None, "quadrotor") else f"is a log of a vehicle that flies, not of a {kind}"


def no_flight(height: Signal | None) -> str:
    """Return what to say of a log in which nothing flies.

    Args:
        height: m.
    """
    values = height.values[np.isfinite(height.values)] if height is not None else np.empty(0)
    if not len(values):
        return "nothing flies in it, as far as it tells; log a flight"
    return f"nothing flies in it: the height changes by {np.ptp(values):.2f} m only; log a flight"


def too_slow(rates: Mapping[str, float], how: str) -> str:
    """Return what to say of a log that is too slow.

    Args:
        rates: topic or message to samples per second.
        how: to log faster.
    """
    shown = ", ".join(f"{topic} at {rate:.0f} Hz" for topic, rate in rates.items())
    least = f"{SLOWEST:.0f} Hz are the least and 100 Hz are good"
    return f"is logged too slowly to show physics: {shown}, where {least}; {how}"
