"""Messages of ROS 1 bags, ROS 2 bags and MCAP files, one after the other, each with what reads its numbers."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from simgap.logs.readers.json_messages import json_numbers
from simgap.logs.readers.ros_messages import Decoded, MessageType
from simgap.logs.readers.unpacking import unpacked

Numbers = Callable[[bytes], Decoded]


@dataclass(frozen=True)
class Channel:
    """What a topic holds.

    Attributes:
        topic: its name.
        type: of its messages.
        numbers: reads one; None where that is not possible.
        reason: why it is not.
    """

    topic: str
    type: str
    numbers: Numbers | None
    reason: str = ""


class Message(NamedTuple):
    """A message as it stands in the file.

    Attributes:
        channel: of it.
        time: at which it was recorded, ns.
        data: packed.
    """

    channel: Channel
    time: int
    data: bytes


def messages_of(path: Path) -> Iterator[Message]:
    """Yield the messages of a file or a folder: of a bag by time, of MCAP in the order in which they were written.

    Raises anything that its libraries raise of a damaged file.
    """
    return _of_mcap(path) if _is_mcap(path) else _of_bag(path)


def _is_mcap(path: Path) -> bool:
    if path.is_dir():
        return False
    with path.open("rb") as file:
        return file.read(1) == b"\x89"


def _of_bag(path: Path) -> Iterator[Message]:
    from rosbags.rosbag1 import Reader as Reader1
    from rosbags.rosbag2 import Reader as Reader2

    first = path.is_file() and path.suffix != ".db3"
    with (Reader1 if first else Reader2)(path) as reader:
        if first:
            _bound(reader)
        channels = {id(entry): _channel_of(entry, padded=not first) for entry in reader.connections}
        known = [entry for entry in reader.connections if entry.msgcount]
        if not known:
            return
        by_key = {(entry.id, entry.topic): channels[id(entry)] for entry in reader.connections}
        for entry, time, data in reader.messages(known):
            yield Message(by_key[entry.id, entry.topic], time, data)


def _bound(reader: Any) -> None:
    """Let no chunk of a bag unpack to more than is sensible."""
    from rosbags.rosbag1.reader import decompressors

    names = {function: name for name, function in decompressors.items()}
    for place, chunk in reader.chunks.items():
        reader.chunks[place] = chunk._replace(
            decompressor=partial(unpacked, compression=names[chunk.decompressor])
        )


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
        return Channel(topic, kind, MessageType(_definitions(kind, text, written_in), kind, padded).numbers)
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


def _of_mcap(path: Path) -> Iterator[Message]:
    from mcap.records import Channel as Record
    from mcap.records import Chunk, Schema
    from mcap.records import Message as Data
    from mcap.stream_reader import StreamReader, breakup_chunk

    schemas: dict[int, Any] = {}
    channels: dict[int, Channel] = {}
    with closing(path.open("rb")) as file:
        reader = StreamReader(file, emit_chunks=True, record_size_limit=path.stat().st_size)
        for record in reader.records:
            for part in breakup_chunk(_plain(record)) if isinstance(record, Chunk) else [record]:
                if isinstance(part, Schema):
                    schemas[part.id] = part
                elif isinstance(part, Record) and part.id not in channels:
                    channels[part.id] = _mcap_channel(part, schemas.get(part.schema_id))
                elif isinstance(part, Data):
                    yield Message(channels[part.channel_id], part.log_time, part.data)


def _plain(chunk: Any) -> Any:
    """Return a chunk that is not compressed."""
    from dataclasses import replace

    data = unpacked(chunk.data, chunk.compression or "none", chunk.uncompressed_size)
    return replace(chunk, data=data, compression="")


def _mcap_channel(channel: Any, schema: Any) -> Channel:
    from rosbags.typesys.msg import normalize_msgtype

    name = schema.name if schema is not None else ""
    encoding = channel.message_encoding
    if encoding == "json":
        return Channel(channel.topic, name or "JSON", json_numbers)
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
