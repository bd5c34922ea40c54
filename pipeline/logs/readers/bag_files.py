"""Messages of ROS 1 bags, ROS 2 bags and MCAP files, many at a time, each with what reads its numbers."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from simgap import compiled
from simgap.artifacts.plain_yaml import read_yaml
from simgap.logs.readers import mcap_records as mcap
from simgap.logs.readers.bag_database import messages_of, opened, rows_of, topics_of
from simgap.logs.readers.json_messages import json_columns
from simgap.logs.readers.packed import Columns, Packed
from simgap.logs.readers.ros_messages import MessageType

_AT_ONCE = 20_000  # messages
_BYTES_AT_ONCE = 1 << 24  # of messages that come one by one, or of a database

Reads = Callable[[Packed], Iterator[Columns]]
"""What reads the numbers of messages."""


@dataclass(frozen=True)
class Channel:
    """What a topic holds.

    Attributes:
        topic: its name.
        type: of its messages.
        columns: reads their numbers; None where that is not possible.
        reason: why it is not.
    """

    topic: str
    type: str
    columns: Reads | None
    reason: str = ""


class Block(NamedTuple):
    """Messages as they stand in the file.

    Attributes:
        channels: that they may be of.
        which: number of the channel of each, (n,).
        times: at which they were recorded, ns, (n,).
        messages: packed.
    """

    channels: Mapping[int, Channel]
    which: NDArray[np.int64]
    times: NDArray[np.int64]
    messages: Packed


def blocks_of(path: Path) -> Iterator[Block]:
    """Yield the messages of a file or a folder: of a bag by time, of MCAP in the order in which they were written.

    Raises anything that its libraries raise of a damaged file, after what was read before it.
    """
    files = _plain_files(path)
    for file in files:
        yield from _of_mcap(file) if _is_mcap(file) else _of_database(file)
    if not files:
        yield from _of_bag1(path) if path.is_file() else _in_blocks(_of_packed(path))


def _plain_files(path: Path) -> list[Path]:
    """Return the files of ROS 2 at a path, in their order; none where it is a bag of ROS 1, or compressed."""
    if path.is_file():
        return [path] if path.suffix == ".db3" or _is_mcap(path) else []
    described = read_yaml(path / "metadata.yaml")
    facts = described.get("rosbag2_bagfile_information") if isinstance(described, dict) else None
    mode = facts.get("compression_mode") if isinstance(facts, dict) else None
    if str(mode or "none").lower() != "none":
        return []
    return sorted((*path.glob("*.mcap"), *path.glob("*.db3")), key=_numbered)


def _is_mcap(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(1) == mcap.MAGIC[:1]


def _numbered(path: Path) -> tuple[int, str]:
    """Return what orders the files of a bag: bag_2.mcap comes before bag_10.mcap."""
    return len(path.name), path.name


def _in_blocks(messages: Iterable[tuple[Channel, int, bytes]]) -> Iterator[Block]:
    """Yield messages that come one by one, together; of a damaged file what comes before the damage."""
    numbers: dict[int, int] = {}
    channels: dict[int, Channel] = {}
    kept: list[tuple[int, int, bytes]] = []
    size = 0
    try:
        for channel, time, data in messages:
            number = numbers.setdefault(id(channel), len(numbers))
            channels[number] = channel
            kept.append((number, time, data))
            size += len(data)
            if len(kept) == _AT_ONCE or size > _BYTES_AT_ONCE:
                yield _block(channels, kept)
                kept, size = [], 0
    except GeneratorExit:
        raise
    except Exception:
        if kept:
            yield _block(channels, kept)
        raise
    if kept:
        yield _block(channels, kept)


def _block(channels: dict[int, Channel], messages: list[tuple[int, int, bytes]]) -> Block:
    which, times, data = zip(*messages, strict=True)
    return Block(channels, np.array(which), np.array(times, dtype=np.int64), Packed.of(data))


def _of_database(path: Path) -> Iterator[Block]:
    with closing(opened(path)) as database:
        channels = {
            topic.number: _ros_channel(topic.name, topic.type, topic.text, topic.written_in, padded=True)
            for topic in topics_of(database)
        }
        ((count,),) = rows_of(database, "SELECT COUNT(*) FROM messages")
        at_once = min(1 + _BYTES_AT_ONCE * count // path.stat().st_size, _AT_ONCE)
        for which, times, messages in messages_of(database, at_once):
            yield from _known(Block(channels, which, times, messages))


def _of_bag1(path: Path) -> Iterator[Block]:
    from simgap.logs.readers.bag1 import IndexedBag

    with IndexedBag(path) as bag:
        recorded = bag.recorded()
        channels = {
            entry.id: _channel_of(entry, padded=False) for entry in bag.connections if entry.id in recorded
        }
        for connections, times, messages in bag.stretches():
            yield from _known(Block(channels, connections, times, messages))


def _known(block: Block) -> Iterator[Block]:
    """Yield a block without the messages of channels that it does not have; nothing where none is left."""
    if block.channels.keys() >= set(np.unique(block.which).tolist()):
        yield block
        return
    known = np.flatnonzero(np.isin(block.which, list(block.channels)))
    if len(known):
        yield Block(block.channels, block.which[known], block.times[known], block.messages[known])


def _of_packed(path: Path) -> Iterator[tuple[Channel, int, bytes]]:
    """Yield the messages of a bag of ROS 2 that is compressed."""
    from rosbags.rosbag2 import Reader

    with Reader(path) as reader:
        known = [entry for entry in reader.connections if entry.msgcount]
        if not known:
            return
        channels = {(entry.id, entry.topic): _channel_of(entry, padded=True) for entry in known}
        for entry, time, data in reader.messages(known):
            yield channels[entry.id, entry.topic], time, data


def _channel_of(connection: Any, padded: bool) -> Channel:
    definition = connection.msgdef
    return _ros_channel(
        connection.topic, connection.msgtype, definition.data, definition.format.name, padded=padded
    )


def _ros_channel(topic: str, kind: str, text: str, written_in: str, padded: bool) -> Channel:
    """Return the channel of ROS messages.

    Args:
        topic: its name.
        kind: type of the messages.
        text: its definition; empty where the file has none.
        written_in: MSG, IDL or NONE.
        padded: whether numbers are padded: ROS 2.
    """
    try:
        return Channel(topic, kind, MessageType(_definitions(kind, text, written_in), kind, padded).columns)
    except (ValueError, KeyError, RecursionError) as error:
        return Channel(topic, kind, None, str(error))


def _definitions(kind: str, text: str, written_in: str) -> Mapping[str, Any]:
    from rosbags.typesys import (
        Stores,
        TypesysError,
        get_types_from_idl,
        get_types_from_msg,
        get_typestore,
    )

    try:
        if written_in == "MSG":
            return get_types_from_msg(text, kind)
        if written_in == "IDL":
            parts = [part.split("\n", 1)[-1] for part in text.split("=" * 80 + "\n") if part.strip()]
            return {name: entry for part in parts for name, entry in get_types_from_idl(part).items()}
    except TypesysError as error:
        raise ValueError(f"its definition cannot be read ({str(error).splitlines()[0]})") from None
    # What is common has been the same since ROS 2 Foxy; Humble was the last release whose bags hold no definitions.
    return get_typestore(Stores.ROS2_HUMBLE).fielddefs


def _of_mcap(path: Path) -> Iterator[Block]:
    content = np.memmap(path, dtype=np.uint8, mode="r")
    if content[: len(mcap.MAGIC)].tobytes() != mcap.MAGIC:
        raise ValueError("does not begin as MCAP does")
    yield from _Mcap(len(content)).blocks(content, len(mcap.MAGIC))
    if content[-len(mcap.MAGIC) :].tobytes() != mcap.MAGIC:
        raise ValueError("does not end as MCAP does")


class _Mcap:
    """What has been read of an MCAP file of some size in bytes."""

    def __init__(self, size: int) -> None:
        self._schemas: dict[int, Any] = {}
        self._channels: dict[int, Channel] = {}
        self._messages = compiled.for_size(mcap.messages, size)
        self._in_json = partial(json_columns, large=size >= compiled.LARGE)

    def blocks(self, content: NDArray[np.uint8], place: int = 0) -> Iterator[Block]:
        """Yield the messages of the file, or of a chunk of it.

        Raises:
            ValueError: when it is damaged, after what was read before.
        """
        view = content.data
        found, places = 0, np.empty(_AT_ONCE, dtype=np.int64)
        damage: ValueError | None = None
        try:
            while place < len(view):
                found, place = self._messages(view, place, found, places.data)
                if found == _AT_ONCE:
                    yield self._block(content, places)
                    found = 0
                elif place < len(view):
                    kind, begin, place = mcap.record(view, place)
                    if kind in (mcap.SCHEMA, mcap.CHANNEL):
                        self._declare(kind, view[begin:place])
                    elif kind == mcap.CHUNK:
                        chunk = mcap.chunk_content(view[begin:place])
                        yield from self.blocks(np.frombuffer(chunk, dtype=np.uint8))
                    elif kind in (mcap.DATA_END, mcap.FOOTER):
                        break
        except ValueError as error:
            damage = error
        if found:
            yield self._block(content, places[:found])
        if damage is not None:
            raise damage

    def _declare(self, kind: int, content: memoryview) -> None:
        entry = mcap.parsed(kind, content)
        if kind == mcap.SCHEMA:
            self._schemas[entry.id] = entry
        elif entry.id not in self._channels:
            self._channels[entry.id] = _mcap_channel(entry, self._schemas.get(entry.schema_id), self._in_json)

    def _block(self, content: NDArray[np.uint8], places: NDArray[np.int64]) -> Block:
        sizes, which, times = mcap.heads(content, places)
        if not set(np.flatnonzero(np.bincount(which)).tolist()) <= self._channels.keys():
            raise ValueError("a message is of no channel")
        return Block(self._channels, which, times, Packed(content, places + mcap.DATA, sizes))


def _mcap_channel(channel: Any, schema: Any, in_json: Reads) -> Channel:
    from rosbags.typesys.msg import normalize_msgtype

    name = schema.name if schema is not None else ""
    encoding = channel.message_encoding
    if encoding == "json":
        return Channel(channel.topic, name or "JSON", in_json)
    if encoding not in ("cdr", "ros1"):
        return Channel(
            channel.topic, name or encoding, None, f"messages in {encoding or 'no encoding'} are not read"
        )
    written_in = {"ros1msg": "MSG", "ros2msg": "MSG", "ros2idl": "IDL", "omgidl": "IDL"}.get(
        schema.encoding if schema is not None else "", "NONE"
    )
    text = schema.data.decode("utf-8", "replace") if schema is not None else ""
    return _ros_channel(
        channel.topic, normalize_msgtype(name), text, written_in if text else "NONE", padded=encoding == "cdr"
    )
