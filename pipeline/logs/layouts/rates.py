"""What a log has too slowly to show physics is left out; where that is the motors or the body rate, it is refused."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from simgap.logs.layouts.choices import rate_of
from simgap.logs.log import Log
from simgap.logs.proposal import Proposed

SLOWEST = 24.0
"""Hz. The rate loop of a quadrotor closes at 5 to 10 Hz and its motors follow in 20 to 60 ms; what moves at 10 Hz needs
more than 20 samples a second (Nyquist), and some room. Below that a command and what it does cannot be told apart."""

_MOTORS = ("motor_speed", "motor_command")
_STATE = ("position", "velocity", "attitude")


@dataclass(frozen=True)
class Rated:
    """Columns, sorted by their rates.

    Attributes:
        columns: that are fast enough; all, where the log is refused, for a person who knows better.
        missing: column to why it was left out.
        notes: sentences on what was left out though it is not needed.
        refused: message or topic to samples per second, of what makes the log useless; empty where it is none.
    """

    columns: Mapping[str, Proposed]
    missing: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    refused: Mapping[str, float] = field(default_factory=dict)


def rated(log: Log, columns: Mapping[str, Proposed], how: str) -> Rated:
    """Leave out what is too slow, or refuse the log.

    Args:
        log: as it was read.
        columns: that are proposed.
        how: to log faster.
    """
    rates: dict[str, tuple[str, float]] = {}
    for column, entry in columns.items():
        group = column.rsplit("_", 1)[0]
        if group in (*_MOTORS, *_STATE, "body_rate"):
            rate = rate_of(log, entry.source.signal)
            if group not in rates or rate < rates[group][1]:
                rates[group] = entry.source.signal.partition(".")[0], rate
    slow = {group: told for group, told in rates.items() if told[1] < SLOWEST}
    motors = [group for group in _MOTORS if group in rates]
    if "body_rate" in slow or (motors and all(group in slow for group in motors)):
        return Rated(columns, refused=dict(slow.values()))
    kept = {name: entry for name, entry in columns.items() if name.rsplit("_", 1)[0] not in slow}
    missing = {
        name: f"{_told(*slow[group])} is too slow, {SLOWEST:.0f} Hz are the least: {how}"
        for name in columns
        if (group := name.rsplit("_", 1)[0]) in slow and group in _STATE
    }
    notes = [
        f"{_told(*slow[group])} is left out: too slow to show motors." for group in _MOTORS if group in slow
    ]
    return Rated(kept, missing, tuple(notes))


def told(rates: Mapping[str, float]) -> str:
    """Return topics with their rates, for a sentence."""
    return ", ".join(_told(topic, rate) for topic, rate in rates.items())


def _told(topic: str, rate: float) -> str:
    return f"{topic} at {rate:.0f} Hz"
