"""Signals of logs made of records: views of the records as they were stored, converted when they are asked for."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal


@dataclass(frozen=True)
class Records:
    """All records of one kind.

    Attributes:
        rows: one structured value a record, (n,).
        time: s of the log's clock, (n,).
        units: of the fields that declare one.
        scales: of the fields that are stored as multiples; 1 otherwise.
        held: fields whose value holds until the next one.
    """

    rows: NDArray[Any]
    time: NDArray[np.float64]
    units: Mapping[str, str] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)
    held: frozenset[str] = frozenset()


class RecordSignals(Mapping[str, Signal]):
    """Every number of every record as a signal.

    A log has a thousand signals, of which some thirty are used. So each is made when it is asked for, and the log takes
    no more memory than its file.
    """

    def __init__(
        self,
        fields: Mapping[str, tuple[Records, str]],
        derived: Mapping[str, Callable[[], Signal]] | None = None,
    ) -> None:
        """Hold the fields: name of a signal to its records and its field in them; and signals computed of others."""
        self._fields = dict(fields)
        self._derived = dict(derived or {})

    def __getitem__(self, name: str) -> Signal:
        if name in self._derived:
            return self._derived[name]()
        records, column = self._fields[name]
        values = records.rows[column].astype("float64")
        scale = records.scales.get(column, 1.0)
        return Signal(
            name,
            records.time,
            values if scale == 1.0 else values * scale,
            records.units.get(column),
            column in records.held,
        )

    def __iter__(self) -> Iterator[str]:
        yield from self._fields
        yield from self._derived

    def __len__(self) -> int:
        return len(self._fields) + len(self._derived)

    def __contains__(self, name: object) -> bool:
        return name in self._fields or name in self._derived
