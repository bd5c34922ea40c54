"""ROS 1 bags, ROS 2 bags and MCAP: every number of every message, by topic and field."""

from pathlib import Path

from simgap.errors import InputError
from simgap.logs.log import Log, Signal, Span
from simgap.logs.readers import odometry
from simgap.logs.readers.bag_files import Channel, Message, messages_of
from simgap.logs.readers.topics import Topic

_NANOSECOND = 1e-9
_BACK = (
    100_000_000  # ns by which time must go back to begin a run: writers of several topics differ by some ms
)
_BETWEEN = 1_000_000_000  # ns from one run to the next, so that they share no time


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
        for message in messages_of(path):
            content.add(message)
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

    def add(self, message: Message) -> None:
        """Add a message; one whose time goes back begins a run."""
        channel = message.channel
        if channel.numbers is None:
            self.unread[channel.topic] = channel
            return
        topic = self.topics.setdefault(channel.topic, Topic(channel.topic))
        self._types[channel.topic] = channel.type
        try:
            found = channel.numbers(message.data)
        except ValueError:
            topic.damaged += 1
            return
        time = self._time(message.time)
        stamp = None if found.stamp is None else (found.stamp + self._shift) * _NANOSECOND
        topic.long |= found.long
        topic.add(time * _NANOSECOND, stamp, found.blocks)

    def _time(self, recorded: int) -> int:
        """Return a time, ns since the first message, behind those of the runs before."""
        if self._origin is None:
            self._origin = recorded
            self._shift = -recorded
            self._spans.append((0, 0))
        time = recorded + self._shift
        if time < self._latest - _BACK:
            self._shift += self._latest + _BETWEEN - time
            time = recorded + self._shift
            self._spans.append((time, time))
        self._latest = max(self._latest, time)
        self._spans[-1] = (self._spans[-1][0], self._latest)
        return time

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
