"""Signals of the messages of one topic."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal
from simgap.logs.readers.packed import Columns

_NANOSECOND = 1e-9
_MOST_SIGNALS = 2000  # of one topic; a humanoid has some hundred, random names of a damaged file have no end
_SAME_CLOCK = (
    5.0  # s by which the stamp of a message may precede its recording: a slow network, no other clock
)

_Part = tuple[NDArray[np.int64], NDArray[np.float64]]
"""Rows of the topic, (n,), and values of some fields in them, (n, names)."""


class Topic:
    """The messages of one topic.

    Attributes:
        name: of the topic.
        damaged: messages that could not be read.
        long: arrays that were left out for their length.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.damaged = 0
        self.long: set[str] = set()
        self._rows = 0
        self._times: list[NDArray[np.float64]] = []
        self._stamps: list[NDArray[np.float64]] = []
        self._blocks: dict[tuple[str, ...], list[_Part]] = {}

    def add(
        self,
        rows: NDArray[np.int64],
        times: NDArray[np.float64],
        shifts: NDArray[np.int64],
        found: Sequence[Columns],
    ) -> None:
        """Add messages.

        Args:
            rows: of `found`, ascending, (n,).
            times: at which they were recorded, s, (n,).
            shifts: what has to be added to their stamps to be on the same clock, ns, (n,).
            found: the numbers in them.
        """
        stamps = np.full(len(rows), np.nan)
        for part in found:
            places = np.arange(len(rows)) if len(found) == 1 else np.searchsorted(rows, part.rows)
            if part.stamps is not None:
                stamps[places] = (part.stamps + shifts[places]) * _NANOSECOND
            for names, values in part.blocks:
                self._blocks.setdefault(names, []).append((self._rows + places, values))
            self.long |= part.long
        self._rows += len(rows)
        self._times.append(times)
        self._stamps.append(stamps)

    def signals(self) -> Iterator[Signal]:
        """Yield the signals, each at the times of its messages; those of one name from all messages that have it."""
        time = self.time()
        for name, (rows, values) in self._columns().items():
            yield Signal(f"{self.name}/{name}", time if len(rows) == len(time) else time[rows], values)

    def time(self) -> NDArray[np.float64]:
        """Return the times of the messages, s: their stamps where `is_stamped`."""
        return _all_of(self._stamps if self.is_stamped() else self._times)

    def is_stamped(self) -> bool:
        """Whether the stamps are of the clock of the recording, and increase."""
        stamps = _all_of(self._stamps)
        late = _all_of(self._times) - stamps
        return bool(len(stamps) and (np.diff(stamps) > 0).all() and (np.abs(late) < _SAME_CLOCK).all())

    def has_stamps(self) -> bool:
        """Whether the messages bear any stamps."""
        return bool((np.abs(_all_of(self._stamps)) > 0).any())

    def too_many(self) -> bool:
        """Whether some signals were left out, since there are too many."""
        return len({name for names in self._blocks for name in names}) > _MOST_SIGNALS

    def _columns(self) -> dict[str, _Part]:
        """Return the values of each field with their rows, one after the other in memory."""
        parts: dict[str, list[_Part]] = {}
        for names in self._blocks:
            rows, values = self._united(names)
            for place, name in enumerate(dict.fromkeys(names)):
                if name in parts or len(parts) < _MOST_SIGNALS:
                    column = place if len(set(names)) == len(names) else names.index(name)
                    parts.setdefault(name, []).append((rows, values[column]))
        return {name: found[0] if len(found) == 1 else _merged(found) for name, found in parts.items()}

    def _united(self, names: tuple[str, ...]) -> _Part:
        """Return the rows of some fields, (n,), and their values, (names, n), and keep them as one part."""
        kept = self._blocks[names]
        values = np.empty((len(names), sum(len(rows) for rows, _ in kept)))
        first = 0
        for rows, part in kept:
            values[:, first : first + len(rows)] = part.T
            first += len(rows)
        rows = np.concatenate([rows for rows, _ in kept])
        if len(kept) > 1:
            self._blocks[names] = [(rows, values.T)]
        return rows, values


def _all_of(parts: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return all parts as one, and keep them as one."""
    if len(parts) != 1:
        parts[:] = [np.concatenate([np.empty(0), *parts])]
    return parts[0]


def _merged(parts: list[_Part]) -> _Part:
    rows = np.concatenate([at for at, _ in parts])
    values = np.concatenate([part for _, part in parts])
    order = np.argsort(rows, kind="stable")
    return rows[order], values[order]
