"""Logs of the micro-SD deck of a Crazyflie: events of several types, each at its own times."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Log
from simgap.logs.records import Records, RecordSignals
from simgap.recordings.importers.event_log import EventLog, read_events

_MICROSECOND = 1e-6
_QUATERNION = "stateEstimateZ.quat"
_STEPS = 511  # of 9 bits, for 0 to 1/√2: no element but the largest is more


def read(path: Path) -> Log:
    """Read the variables of a log, by the names that the firmware gives them; those of a second type that have a name
    of a first one as `event/variable`. A compressed quaternion is unpacked as `stateEstimateZ.quat/w` and so on.

    Raises:
        InputError: when the file is damaged.
    """
    log = read_events(path)
    fields: dict[str, tuple[Records, str]] = {}
    for event in log.events:
        for name, found in _fields(log, event):
            fields[name if name not in fields else f"{event}/{name}"] = found
    remarks = (
        ()
        if log.whole
        else ("Its checksum is missing or wrong: it was cut off, and the last event with it.",)
    )
    facts = {event: f"{len(rows)} events" for event, rows in log.events.items()}
    return Log("Crazyflie", str(path), RecordSignals(fields), facts=facts, remarks=remarks)


def _fields(log: EventLog, event: str) -> Iterator[tuple[str, tuple[Records, str]]]:
    """Yield the variables of a type of events, each with its records and its name in them."""
    rows, time = log.events[event], log.time(event).astype("float64") * _MICROSECOND
    records = Records(rows, time)
    for name in log.variables(event):
        if name == _QUATERNION:
            elements = np.rec.fromarrays(
                list(unpacked_quaternion(rows[name])), dtype=np.dtype([(axis, "f8") for axis in "xyzw"])
            )
            yield from ((f"{name}/{axis}", (Records(elements, time), axis)) for axis in "xyzw")
        else:
            yield name, (records, name)


def unpacked_quaternion(packed: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return quaternions x, y, z, w, shape (4, n), from 32 bits each.

    Two bits number the largest element, which is positive; then a sign and nine bits for each of the others.
    Source: src/utils/interface/quatcompress.h of bitcraze/crazyflie-firmware.

    Args:
        packed: (n,).
    """
    rest = packed.astype(np.int64) & 0xFFFFFFFF
    largest = rest >> 30
    elements = np.zeros((4, len(rest)))
    for place in (3, 2, 1, 0):
        others = largest != place
        size = (rest & _STEPS) / _STEPS * np.sqrt(0.5)
        elements[place] = np.where(others, np.where(rest >> 9 & 1, -size, size), 0.0)
        rest = np.where(others, rest >> 10, rest)
    left = np.sqrt(np.maximum(0.0, 1.0 - (elements**2).sum(axis=0)))
    elements[largest, np.arange(len(rest))] = left
    return elements
