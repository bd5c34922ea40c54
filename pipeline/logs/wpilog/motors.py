"""Motors of SysId routines in a log; several of them one behind the other, each test of each a run."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simgap.logs.log import Signal, Span
from simgap.logs.wpilog.spans import mechanisms_of

QUANTITIES = ("voltage", "position", "velocity")
_MORE = ("current",)
_NAME = re.compile(rf"({'|'.join((*QUANTITIES, *_MORE))})-(.+)")
_PAUSE = 1.0  # s between the times of two motors; any time above zero keeps them apart
JOINED = "sysid/"
"""Before `voltage`, `position` and `velocity`: the name of a signal of all motors, one behind the other."""


@dataclass(frozen=True)
class Motor:
    """A motor of a SysId routine.

    Attributes:
        name: as the robot's program calls it.
        signals: quantity to signal.
    """

    name: str
    signals: Mapping[str, str]


def sysid_motors(names: Sequence[str], entries: Sequence[str]) -> list[Motor]:
    """Return the motors whose voltage, position and velocity were logged as SysId does: `voltage-MOTOR-ROUTINE`.

    Args:
        names: of the signals.
        entries: names of all entries, of which some name the routines.
    """
    routines = mechanisms_of(entries)
    found: dict[str, dict[str, str]] = {}
    for name in names:
        match = _NAME.fullmatch(name.rsplit("/", 1)[-1])
        routine = next((each for each in routines if match and match[2].endswith(f"-{each}")), None)
        if match is not None and routine is not None:
            found.setdefault(match[2].removesuffix(f"-{routine}"), {})[match[1]] = name
    return [Motor(name, own) for name, own in sorted(found.items()) if set(QUANTITIES) <= set(own)]


def joined(
    motors: Sequence[Motor], signals: Mapping[str, Signal], spans: Sequence[Span]
) -> dict[str, Signal]:
    """Return one signal a quantity for all motors: that of each motor is moved behind the one before it.

    Motors are left apart where their units differ or one motor alone was logged.
    """
    if len(motors) < 2 or not spans:
        return {}
    found = {}
    for quantity in (*QUANTITIES, *_MORE):
        if not all(quantity in motor.signals for motor in motors):
            continue
        own = [signals[motor.signals[quantity]] for motor in motors]
        if len({signal.unit for signal in own}) > 1:
            return {}
        end, period = max(span.end for span in spans), period_of(spans)
        kept = [signal.time <= end for signal in own]
        time = [
            signal.time[keep] + place * period
            for place, (signal, keep) in enumerate(zip(own, kept, strict=True))
        ]
        values = [signal.values[keep] for signal, keep in zip(own, kept, strict=True)]
        name = JOINED + quantity
        found[name] = replace(own[0], name=name, time=np.concatenate(time), values=np.concatenate(values))
    return found


def period_of(spans: Sequence[Span]) -> float:
    """Return by how much the times of each motor are later than those of the one before, s."""
    return math.ceil(max(span.end for span in spans)) + _PAUSE


def motor_spans(
    motors: Sequence[Motor], signals: Mapping[str, Signal], spans: Sequence[Span]
) -> tuple[Span, ...]:
    """Return the runs of joined motors: each test of each motor that was logged in it, named `TEST-MOTOR`."""
    period = period_of(spans)
    return tuple(
        Span(f"{span.name}-{motor.name}", span.begin + place * period, span.end + place * period)
        for place, motor in enumerate(motors)
        for span in spans
        if _logged(signals[motor.signals["velocity"]], span)
    )


def _logged(signal: Signal, span: Span) -> bool:
    begin, end = np.searchsorted(signal.time, [span.begin, span.end])
    return bool(end - begin > 1)
