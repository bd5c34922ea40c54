"""Signals of messages that come one by one, topic by topic; what is kept of them is their numbers, packed."""

from array import array
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from simgap.logs.log import Signal

_MOST_SIGNALS = 2000  # of one topic; a humanoid has some hundred, random names of a damaged file have no end
_SAME_CLOCK = (
    5.0  # s by which the stamp of a message may precede its recording: a slow network, no other clock
)


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
        self._times = array("d")
        self._stamps = array("d")
        self._blocks: dict[tuple[str, ...], tuple[array[int], array[float]]] = {}

    def add(
        self,
        time: float,
        stamp: float | None,
        blocks: Iterable[tuple[tuple[str, ...], Sequence[int | float]]],
    ) -> None:
        """Add a message.

        Args:
            time: at which it was recorded, s.
            stamp: the time that it bears, on the same clock, s.
            blocks: names and values of its fields.
        """
        row = len(self._times)
        self._times.append(time)
        self._stamps.append(np.nan if stamp is None else stamp)
        for names, values in blocks:
            if names not in self._blocks:
                self._blocks[names] = array("q"), array("d")
            rows, kept = self._blocks[names]
            rows.append(row)
            kept.extend(values)

    def signals(self) -> Iterator[Signal]:
        """Yield the signals, each at the times of its messages; those of one name from all messages that have it."""
        time = self.time()
        for name, (rows, values) in self._columns().items():
            yield Signal(f"{self.name}/{name}", time if len(rows) == len(time) else time[rows], values)

    def time(self) -> NDArray[np.float64]:
        """Return the times of the messages, s: their stamps where `is_stamped`."""
        return np.array(self._stamps if self.is_stamped() else self._times)

    def is_stamped(self) -> bool:
        """Whether the stamps are of the clock of the recording, and increase."""
        stamps = np.array(self._stamps)
        late = np.array(self._times) - stamps
        return bool(len(stamps) and (np.diff(stamps) > 0).all() and (np.abs(late) < _SAME_CLOCK).all())

    def has_stamps(self) -> bool:
        """Whether the messages bear any stamps."""
        return bool(np.any(np.nan_to_num(np.array(self._stamps)) != 0))

    def too_many(self) -> bool:
        """Whether some signals were left out, since there are too many."""
        return len({name for names in self._blocks for name in names}) > _MOST_SIGNALS

    def _columns(self) -> dict[str, tuple[NDArray[np.int64], NDArray[np.float64]]]:
        parts: dict[str, list[tuple[NDArray[np.int64], NDArray[np.float64]]]] = {}
        for names, (rows, kept) in self._blocks.items():
            at = np.frombuffer(rows, dtype=np.int64)
            values = np.frombuffer(kept).reshape(len(at), len(names)) if names else np.empty((len(at), 0))
            for place, name in enumerate(dict.fromkeys(names)):
                if name in parts or len(parts) < _MOST_SIGNALS:
                    column = place if len(set(names)) == len(names) else names.index(name)
                    parts.setdefault(name, []).append((at, values[:, column]))
        return {name: _joined(found) for name, found in parts.items()}


def _joined(
    parts: list[tuple[NDArray[np.int64], NDArray[np.float64]]],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    rows = np.concatenate([at for at, _ in parts])
    values = np.concatenate([part for _, part in parts])
    order = np.argsort(rows, kind="stable")
    return rows[order], values[order]
