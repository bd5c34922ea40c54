"""ROS 1 bags, ROS 2 bags and MCAP: every number of every message, by topic and field."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.log import Log, Signal, Span
from simgap.logs.readers import odometry
from simgap.logs.readers.bag_files import Block, Channel, blocks_of
from simgap.logs.readers.packed import Columns
from simgap.logs.readers.topics import Topic

_NANOSECOND = 1e-9
_BACK = (
    100_000_000  # ns by which time must go back to begin a run: writers of several topics differ by some ms
)
_BETWEEN = 1_000_000_000  # ns from one run to the next, so that they share no time
_FARTHEST = 1 << 61  # ns by which a run is moved; only the times of a damaged file are so far apart


def read(path: Path) -> Log:
    """Read the messages of a bag as signals `topic/field`, with the elements of an array by the names beside it.

    The time is that of a message's header where it is of the recorder's clock, else that of the recording. A file in
    which the time goes back holds several runs; they are laid one behind the other. Arrays of many elements (images,
    point clouds) and messages whose type has no definition are left out, and said.

    Args:
        path: a .bag, .db3 or .mcap file, or the folder of a ROS 2 bag.

    Raises:
        InputError: when no message can be read.
    """
    content = _Content()
    try:
        for block in blocks_of(path):
            content.add(block)
    except (InputError, ModuleNotFoundError):
        raise
    except Exception as error:  # of a damaged file the libraries raise anything
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        if not content.topics:
            remedy = "copy it again, or rebuild its index: rosbag reindex, ros2 bag reindex, mcap recover"
            raise InputError(f"cannot be read ({reason})", str(path), remedy) from None
        content.remarks.append(f"The file is damaged or was cut off ({reason}): what follows is not read.")
    if not content.topics and not content.unread:
        raise InputError(
            "holds no messages", str(path), "record it again, and see that the topics are published"
        )
    return content.log(path)


class _Content:
    """What has been read of a file."""

    def __init__(self) -> None:
        self.topics: dict[str, Topic] = {}
        self.unread: dict[str, Channel] = {}
        self.remarks: list[str] = []
        self._types: dict[str, str] = {}
        self._origin: int | None = None
        self._shift = 0
        self._latest = 0
        self._spans: list[tuple[int, int]] = []

    def add(self, block: Block) -> None:
        """Add messages; one whose time goes back begins a run."""
        topics: list[tuple[Topic, NDArray[np.int64], NDArray[np.int64], list[Columns]]] = []
        for number in np.flatnonzero(np.bincount(block.which)).tolist():
            channel, places = block.channels[number], np.flatnonzero(block.which == number)
            if channel.columns is None:
                self.unread[channel.topic] = channel
                continue
            self._types[channel.topic] = channel.type
            topic = self.topics.setdefault(channel.topic, Topic(channel.topic))
            found = list(channel.columns(block.messages[places]))
            rows = _ascending([part.rows for part in found]) if found else places[:0]
            topic.damaged += len(places) - len(rows)
            if len(rows):
                topics.append((topic, places[rows], rows, found))
        if not topics:
            return
        read = _ascending([places for _, places, _, _ in topics])
        shifts = np.zeros(len(block.which), dtype=np.int64)
        shifts[read] = self._shifts(block.times[read])
        for topic, places, rows, found in topics:
            times = np.asarray((block.times[places] + shifts[places]) * _NANOSECOND, dtype=np.float64)
            topic.add(rows, times, shifts[places], found)

    def _shifts(self, recorded: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return what moves times, ns, to ns since the first message, and behind those of the runs before."""
        if self._origin is None:
            self._origin = int(recorded[0])
            self._shift = -self._origin
            self._spans.append((0, 0))
        moved = recorded + self._shift
        latest_before = np.maximum.accumulate(np.append(self._latest, moved))
        if not (moved < latest_before[:-1] - _BACK).any():  # no run begins in between, as almost always
            self._latest = int(latest_before[-1])
            self._spans[-1] = (self._spans[-1][0], self._latest)
            return np.full(len(recorded), self._shift)
        begins, shifts = [0], [self._shift]
        latest, shift = self._latest, self._shift
        for place, time in enumerate(recorded.tolist()):
            if time + shift > latest:
                latest = time + shift
            elif time + shift < latest - _BACK:
                self._spans[-1] = (self._spans[-1][0], latest)
                shift = min(latest + _BETWEEN - time, _FARTHEST)
                latest = max(latest, time + shift)
                self._spans.append((time + shift, latest))
                begins.append(place)
                shifts.append(shift)
        self._latest, self._shift = latest, shift
        self._spans[-1] = (self._spans[-1][0], latest)
        return np.repeat(np.array(shifts), np.diff(np.array([*begins, len(recorded)])))

    def log(self, path: Path) -> Log:
        """Return the log."""
        signals: dict[str, Signal] = {}
        for topic in self.topics.values():
            signals |= {signal.name: signal for signal in topic.signals()}
            if self._types[topic.name] == odometry.TYPE:
                turned = odometry.world_velocity(topic.name, signals)
                signals |= {signal.name: signal for signal in turned}
        return Log(
            "bag",
            str(path),
            signals,
            spans=self._runs(),
            facts=dict(self._types),
            remarks=(*self.remarks, *self._left_out()),
        )

    def _runs(self) -> tuple[Span, ...]:
        if len(self._spans) < 2:
            return ()
        return tuple(
            Span(f"run_{number}", begin * _NANOSECOND, end * _NANOSECOND)
            for number, (begin, end) in enumerate(self._spans, 1)
        )

    def _left_out(self) -> list[str]:
        """Return what was left out, in sentences."""
        found = [
            f"{channel.topic} ({channel.type}) is left out: {channel.reason}."
            for channel in self.unread.values()
        ]
        if len(self._spans) > 1:
            found.append(
                f"The time goes back {len(self._spans) - 1} times: each stretch is a run of its own."
            )
        for topic in self.topics.values():
            if topic.damaged:
                found.append(f"{topic.name}: {topic.damaged} messages are damaged and left out.")
            if topic.long:
                found.append(f"{topic.name}: long arrays are left out: {', '.join(sorted(topic.long))}.")
            if topic.too_many():
                found.append(f"{topic.name}: it has too many fields; the last ones are left out.")
            if topic.has_stamps() and not topic.is_stamped():
                found.append(
                    f"{topic.name}: its stamps are of another clock, or do not increase; the times of the recording "
                    "are used."
                )
        return found


def _ascending(parts: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Return ascending numbers of several parts as one."""
    return parts[0] if len(parts) == 1 else np.sort(np.concatenate(parts))
