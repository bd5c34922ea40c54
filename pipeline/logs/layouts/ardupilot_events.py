"""When ArduPilot says that it flies: its events."""

import numpy as np

from simgap.logs.layouts.flights import Stretch
from simgap.logs.log import Log, Span

_ARMED, _DISARMED, _LANDED, _AIRBORNE = 10, 11, 18, 28  # EV.Id
_CRASH = 12  # ERR.Subsys, of the detector of crashes
_CLOCKS = ("ATT.Roll", "IMU.AccZ", "RCOU.C1", "RCOU.Ch1")


def said(log: Log) -> list[Stretch]:
    """Return when the vehicle is not on the ground by its events; all of the log where it has none.

    Older firmware misses some take-offs: a landing ends what began when it was armed.
    """
    begin, end = _extent(log)
    if "EV.Id" not in log.signals:
        return [Stretch(begin, end)]
    found: list[Stretch] = []
    armed: float | None = None
    airborne: float | None = None
    events = log.signals["EV.Id"]
    for time, event in zip(events.time.tolist(), events.values.tolist(), strict=True):
        if event == _ARMED:
            armed = time
        elif event == _AIRBORNE:
            airborne = time
        elif event in (_LANDED, _DISARMED):
            since = airborne if airborne is not None else armed
            if since is not None:
                found.append(Stretch(since, time))
            armed = airborne = None
            if event == _LANDED:
                armed = time  # it may take off again
    since = airborne if airborne is not None else armed
    if since is not None:
        found.append(Stretch(since, end, to_ground=False))
    return found


def crash_free(log: Log, spans: tuple[Span, ...]) -> tuple[Span, ...]:
    """Return the flights, which a crash ends."""
    if not {"ERR.Subsys", "ERR.ECode"} <= set(log.signals):
        return spans
    subsystem, code = log.signals["ERR.Subsys"], log.signals["ERR.ECode"]
    crashes = subsystem.time[(subsystem.values == _CRASH) & (code.values > 0)]
    kept = []
    for span in spans:
        inside = crashes[(crashes > span.begin) & (crashes <= span.end)]
        kept.append(Span(span.name, span.begin, float(inside[0]) if len(inside) else span.end))
    return tuple(kept)


def _extent(log: Log) -> tuple[float, float]:
    times = [
        log.signals[name].time for name in _CLOCKS if name in log.signals and len(log.signals[name].time)
    ]
    if not times:
        return 0.0, 0.0
    return float(min(np.min(time) for time in times)), float(max(np.max(time) for time in times))
