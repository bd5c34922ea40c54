"""How sure the share of the gap closed is, in words."""

from typing import Any

from simgap.report.text import NARROW_SPACE, interval

NO_INTERVAL = "one run: no interval"
"""What is said in place of an interval over runs where one run was held out."""


def why_unknown(fit: dict[str, Any]) -> str:
    """Say why the share of the gap closed is not given."""
    held_out = fit.get("held_out_runs")
    return "the error is too close to its floor to measure it" if held_out else "no run could be held out"


def sureness(fit: dict[str, Any]) -> str:
    """Write the interval of the share of the gap closed, or why there is none; empty where that is not known."""
    bounds = interval(fit.get("gap_closed_interval"))
    if bounds:
        return f"95{NARROW_SPACE}% interval {bounds}"
    return NO_INTERVAL if len(fit.get("held_out_runs") or []) == 1 else ""
