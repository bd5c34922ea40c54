"""Databases of ROS 2 bags: topics, and messages many at a time.

`rosbags` would count the messages of each topic first, which takes as long as reading them. Source of the tables:
rosbag2_storage_sqlite3 of ros2/rosbag2.
"""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from simgap.logs.readers.packed import Packed

_FETCHED = 500  # rows at once: so few are still near the processor when they are packed
_FORMATS = {"ros2msg": "MSG", "ros2idl": "IDL"}


class Topic(NamedTuple):
    """What a database says of a topic.

    Attributes:
        number: in the database.
        name: of the topic.
        type: of its messages.
        text: definition of the type; empty where the database has none.
        written_in: MSG, IDL or NONE.
    """

    number: int
    name: str
    type: str
    text: str
    written_in: str


def opened(path: Path) -> Any:
    """Return a connection to a database that is only read."""
    import apsw

    flags = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
    return apsw.Connection(f"{path.absolute().as_uri()}?immutable=1", flags=flags)


def topics_of(database: Any) -> Iterator[Topic]:
    """Yield the topics; definitions of their types are there since ROS 2 Iron."""
    definitions: dict[str, tuple[str, str]] = {}
    tables = database.execute("SELECT name FROM sqlite_master WHERE name = 'message_definitions'")
    for kind, encoding, text in (
        database.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions ORDER BY id"
        )
        if tables.fetchall()
        else ()
    ):
        definitions.setdefault(kind, (text, _FORMATS.get(encoding, "NONE")))
    for number, name, kind in database.execute("SELECT id, name, type FROM topics ORDER BY id"):
        yield Topic(number, name, kind, *definitions.get(kind, ("", "NONE")))


def messages_of(database: Any, at_once: int) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64], Packed]]:
    """Yield numbers of topics, times, ns, and messages by time.

    Args:
        database: that is opened.
        at_once: messages.
    """
    rows = database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp")
    fetched = min(_FETCHED, at_once)
    while found := list(islice(rows, fetched)):
        which: list[int] = []
        times: list[int] = []
        sizes: list[int] = []
        data: list[bytes] = []
        while found:
            some, moments, messages = zip(*found, strict=True)
            which += some
            times += moments
            sizes += map(len, messages)
            data.append(b"".join(messages))
            found = list(islice(rows, fetched)) if len(which) < at_once else []
        yield np.array(which), np.array(times, dtype=np.int64), Packed.joined(data, sizes)
