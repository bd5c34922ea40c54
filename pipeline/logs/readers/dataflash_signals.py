"""The records of a DataFlash log as signals: their clock, their instances, and the attitude as a quaternion."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal
from simgap.logs.records import Records, RecordSignals

if TYPE_CHECKING:
    from simgap.logs.readers.dataflash import Message

_CLOCKS = (("T", 1000.0), ("TimeUS", 1.0), ("TimeMS", 1000.0))
"""Fields with the time, and their unit in µs. Old GPS records have the vehicle's in T, the satellites' in TimeMS."""
_OWN_CLOCKS = ("TimeUS", "TimeMS")
_EVENTS = frozenset({"EV", "MODE", "ARM", "ERR"})  # what was logged when it changed holds
_DESCRIBING = frozenset({"FMT", "FMTU", "UNIT", "MULT", "PARM", "MSG", "FILE"})  # no signals
_ANGLES = ("Roll", "Pitch", "Yaw")


def signals_of(messages: "Mapping[str, Message]", units: Mapping[str, Mapping[str, str]]) -> RecordSignals:
    """Return every number of every message as a signal.

    Args:
        messages: by name.
        units: message to field to unit; `#` for the field that counts instances.
    """
    clock = _Clock(messages)
    fields: dict[str, tuple[Records, str]] = {}
    for name, message in messages.items():
        if name in _DESCRIBING:
            continue
        own = units.get(name, {})
        counter = next((column for column, unit in own.items() if unit == "#"), None)
        for instance, rows, time in _instances(message, clock.time_of(message), counter):
            prefix = f"{name}[{instance}]" if instance else name
            held = frozenset(rows.dtype.names or ()) if name in _EVENTS else frozenset()
            records = Records(rows, time, own, message.scales, held)
            for column in rows.dtype.names or ():
                if column not in _OWN_CLOCKS and rows.dtype[column].kind in "iuf":
                    fields[f"{prefix}.{column}"] = (records, column)
    return RecordSignals(fields, dict(_quaternion(fields)))


def _instances(
    message: "Message", time: NDArray[np.float64], counter: str | None
) -> Iterator[tuple[int, NDArray[Any], NDArray[np.float64]]]:
    """Yield each instance with its rows and times."""
    if counter is None or message.rows.dtype[counter].kind not in "iu":
        yield 0, message.rows, time
        return
    numbers = message.rows[counter]
    present = np.unique(numbers).tolist()
    for number in present:
        own = slice(None) if len(present) == 1 else numbers == number
        yield int(number), message.rows[own], time[own]


class _Clock:
    """The time of each record; those without a field for it have that of the record before."""

    def __init__(self, messages: "Mapping[str, Message]") -> None:
        self._messages = messages
        self._known: tuple[NDArray[np.int64], NDArray[np.float64]] | None = None

    def time_of(self, message: "Message") -> NDArray[np.float64]:
        own = _own_time(message)
        if own is not None:
            return own
        if self._known is None:
            timed = [
                (each.starts, time)
                for each in self._messages.values()
                if (time := _own_time(each)) is not None
            ]
            starts = np.concatenate([np.empty(0, dtype=np.int64), *(each for each, _ in timed)])
            order = np.argsort(starts, kind="stable")
            times = np.concatenate([np.empty(0), *(time for _, time in timed)])
            self._known = starts[order], times[order]
        starts, times = self._known
        if not len(starts):
            return np.zeros(len(message.rows))
        return times[np.maximum(np.searchsorted(starts, message.starts) - 1, 0)]


def _own_time(message: "Message") -> NDArray[np.float64] | None:
    names = message.rows.dtype.names or ()
    for column, scale in _CLOCKS:
        if (
            column in names
            and (column != "T" or "TimeMS" in names)
            and message.rows.dtype[column].kind in "iu"
        ):
            return 1e-6 * (message.rows[column].astype("float64") * scale)
    return None


def _quaternion(fields: Mapping[str, tuple[Records, str]]) -> Iterator[tuple[str, Any]]:
    if all(f"ATT.{angle}" in fields for angle in _ANGLES):
        records = fields["ATT.Roll"][0]
        for index, part in enumerate("wxyz"):
            yield f"ATT.quaternion.{part}", partial(_part, records, index, f"ATT.quaternion.{part}")


def _part(records: Records, index: int, name: str) -> Signal:
    """Return one part of the attitude of ATT, of roll, pitch and yaw in degrees (turns about z, then y, then x)."""
    halves = [
        np.deg2rad(records.rows[angle].astype("float64") * records.scales.get(angle, 1.0)) / 2
        for angle in _ANGLES
    ]
    (cr, cp, cy), (sr, sp, sy) = [np.cos(half) for half in halves], [np.sin(half) for half in halves]
    parts = (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )
    return Signal(name, records.time, parts[index], "1")
