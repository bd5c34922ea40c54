"""A log: named signals, each with its own times, in the frames and units of the file."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Signal:
    """One quantity as the file holds it.

    Attributes:
        name: as the file names it, with `/` or `.` between the levels; unique in the log.
        time: s of the log's clock, in the order of the file, (n,). A time that does not increase is kept:
            the mapping decides.
        values: (n,), missing values as NaN.
        unit: as the file declares it; None where it does not.
        held: whether a value holds until the next one, as of a command or of what is written on change only.
    """

    name: str
    time: NDArray[np.float64]
    values: NDArray[np.float64]
    unit: str | None = None
    held: bool = False


@dataclass(frozen=True)
class Span:
    """A run that the file itself marks: an episode, a test, one log of a flash memory, a flight.

    Attributes:
        name: of the run.
        begin: first time, s of the log's clock.
        end: last time, s of the log's clock.
    """

    name: str
    begin: float
    end: float


@dataclass(frozen=True)
class Log:
    """What a file holds, before anything is made of it.

    The clock of a table is its row number, since only the mapping says which column is the time.

    Attributes:
        format: name of the format, as in `simgap.logs.formats`.
        path: of the file, to name in an error.
        signals: by name.
        spans: the runs that the file marks; empty where it marks none. A reader of a file with several clocks puts
            one behind the other, so that no two runs share a time.
        facts: what the file says of machine and software, for a person to read: {"airframe": "4011"}.
        remarks: sentences about what was damaged or left out.
        texts: columns of a table that hold text, by name, one value a row: they may name the run.
        tabular: whether the log is a table, with the row number (from 0) as its clock.
    """

    format: str
    path: str
    signals: Mapping[str, Signal]
    spans: tuple[Span, ...] = ()
    facts: Mapping[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    texts: Mapping[str, NDArray[np.object_]] = field(default_factory=dict)
    tabular: bool = False
