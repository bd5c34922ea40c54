"""The list of signals begins with what a person looks for."""

import numpy as np

from simgap.logs.listing import signal_lines
from simgap.logs.log import Log, Signal

TIME = np.linspace(0.0, 1.0, 11)


def listed(log: Log, used: list[str], every: bool = False) -> list[str]:
    """Return the names in the order of the list."""
    lines = list(signal_lines(log, used, every))
    return [line.split()[0] for line in lines[3:] if not line.startswith("and ")]


def test_used_signals_come_first_and_those_that_never_change_last():
    values = {
        "mode": np.zeros(11),
        "lost": np.full(11, np.nan),
        "current": np.sin(TIME),
        "once": np.r_[np.nan, np.ones(10)],
        "position": TIME,
    }
    log = Log("test", "log", {name: Signal(name, TIME, series) for name, series in values.items()})
    assert listed(log, ["position"]) == ["position", "current", "mode", "lost", "once"]


def test_constants_hide_nothing_that_moves():
    still = {f"constant {n}": np.full(11, float(n)) for n in range(100)}
    values = {**still, "speed": TIME}
    log = Log("test", "log", {name: Signal(name, TIME, series) for name, series in values.items()})
    assert listed(log, [])[0] == "speed"
    assert list(signal_lines(log, []))[-1] == "and 61 more: --all lists them"
    assert len(listed(log, [], every=True)) == 101
