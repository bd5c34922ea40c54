"""Signals of a WPILib DataLog: the numbers of its entries, of arrays and structs too."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal
from simgap.logs.wpilog.entries import Entry
from simgap.logs.wpilog.records import Records
from simgap.logs.wpilog.schema import Layout, Number, layout_of
from simgap.logs.wpilog.units import unit_of

_NUMBERS = {"boolean": "u1", "int64": "<i8", "float": "<f4", "double": "<f8"}
_LONGEST = (
    32  # elements of an array that become signals: a drivetrain has at most eight, a matrix is no signal
)
_ON_CHANGE = (
    0.01  # share of equal neighbours, up to which a value was written on change: some are written twice
)
_PAUSE = 5.0  # cycles without a record, from which on nothing changed; as `common_times` calls a gap


@dataclass(frozen=True)
class Decoded:
    """The signals of an entry.

    Attributes:
        signals: none where the type is no number.
        on_change: whether they were written only when one of them changed.
        remarks: sentences about what was left out.
    """

    signals: tuple[Signal, ...] = ()
    on_change: bool = False
    remarks: tuple[str, ...] = ()


def decode(entry: Entry, records: Records, schemas: Mapping[str, str]) -> Decoded:
    """Return the signals of an entry; texts, JSON and bytes have none.

    An array gives one signal an element, `name[0]` and so on. A struct gives one a number, `name/field`.

    Args:
        entry: of the file.
        records: of the file.
        schemas: text of each struct's schema, by the name of the struct.
    """
    single = entry.type.removesuffix("[]")
    if single.startswith("struct:"):
        layout = layout_of(single.removeprefix("struct:"), schemas)
        if layout is None:
            return Decoded(remarks=(f"{entry.name!r}: the log does not say what a {single} is.",))
    elif single in _NUMBERS:
        width = int(_NUMBERS[single][-1])
        layout = Layout((Number("", _NUMBERS[single], 0, unit_of(entry.name, entry.metadata)),), width)
    else:
        return Decoded()
    return _signals(entry, records, layout, is_array=entry.type.endswith("[]"))


def cycle_of(signals: Mapping[str, Signal]) -> float:
    """Return the time of one cycle of the robot's program, s: the least of the signals' typical steps; 0 if unknown."""
    steps = [
        float(np.median(np.diff(signal.time), overwrite_input=True))
        for signal in signals.values()
        if len(signal.time) > _LONGEST
    ]
    return min(steps, default=0.0)


def has_pause(signal: Signal, cycle: float, end: float) -> bool:
    """Return whether nothing was written for a while.

    Args:
        signal: of the file.
        cycle: of the robot's program, s.
        end: of the log, s.
    """
    return bool((np.diff(np.append(signal.time, end)) > _PAUSE * cycle).any())


def _signals(entry: Entry, records: Records, layout: Layout, is_array: bool) -> Decoded:
    size, place = records.size[entry.records].astype(np.uint32), entry.records
    counts = size // layout.size
    right = size % layout.size == 0 if is_array else size == layout.size
    remarks = []
    if not right.all():
        wrong = int(np.count_nonzero(~right))
        remarks.append(f"{entry.name!r}: {wrong} records have a wrong size; they were left out.")
        place, counts = place[right], counts[right]
    longest = int(counts.max(initial=0)) if is_array else 1
    if longest > _LONGEST:
        remarks.append(f"{entry.name!r}: of its {longest} elements only the first {_LONGEST} were read.")
    signals, strange, same = [], 0, np.ones(max(len(place) - 1, 0), bool)
    time = records.time[place] / 1e6
    for element in range(min(longest, _LONGEST)):
        has = counts > element
        own, times = (place, time) if has.all() else (place[has], time[has])
        name = f"{entry.name}[{element}]" if is_array else entry.name
        for number, values in _numbers(records, layout, own, element):
            same &= values[1:] == values[:-1] if len(own) == len(place) else False
            strange += _clear_strange(values, number.dtype)
            full = f"{name}/{number.path}" if number.path else name
            unit = number.unit or (unit_of(full, "") if number.path else None)
            signals.append(Signal(full, times, values, unit))
    if strange:
        remarks.append(f"{entry.name!r}: {strange} values were never set; they count as missing.")
    on_change = int(np.count_nonzero(same)) <= _ON_CHANGE * len(place)
    return Decoded(tuple(signals), on_change, tuple(remarks))


def _numbers(
    records: Records, layout: Layout, place: NDArray[Any], element: int
) -> Iterator[tuple[Number, NDArray[np.float64]]]:
    begin = records.begin[place] + element * layout.size
    for number in layout.numbers:
        found = records.numbers(number.dtype, begin + number.offset)
        yield number, found.astype(np.float64, copy=False)


def _clear_strange(values: NDArray[np.float64], dtype: str) -> int:
    """Turn what no sensor gives, a number below the least normal one, to NaN; it is memory that was never written."""
    if dtype[-2] != "f":
        return 0
    size = np.abs(values)
    strange = (size < np.finfo(dtype).tiny) & (size > 0)
    values[strange] = np.nan
    return int(np.count_nonzero(strange))
