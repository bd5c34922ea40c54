"""Databases of ROS 2 bags: topics, and messages many at a time.

`rosbags` would count the messages of each topic first, which takes as long as reading them. Source of the tables:
rosbag2_storage_sqlite3 of ros2/rosbag2.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from simgap.logs.readers.packed import Packed

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
    from adbc_driver_sqlite import dbapi

    return dbapi.connect(f"{path.absolute().as_uri()}?mode=ro&immutable=1", autocommit=True)


def rows_of(database: Any, query: str) -> list[tuple[Any, ...]]:
    """Return the rows that a query finds; few of them, each is made of Python's objects."""
    with database.cursor() as cursor:
        found: list[tuple[Any, ...]] = cursor.execute(query).fetchall()
    return found


def topics_of(database: Any) -> Iterator[Topic]:
    """Yield the topics; definitions of their types are there since ROS 2 Iron."""
    definitions: dict[str, tuple[str, str]] = {}
    if rows_of(database, "SELECT name FROM sqlite_master WHERE name = 'message_definitions'"):
        query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions ORDER BY id"
        for kind, encoding, text in rows_of(database, query):
            definitions.setdefault(kind, (text, _FORMATS.get(encoding, "NONE")))
    for number, name, kind in rows_of(database, "SELECT id, name, type FROM topics ORDER BY id"):
        yield Topic(number, name, kind, *definitions.get(kind, ("", "NONE")))


def messages_of(database: Any, at_once: int) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64], Packed]]:
    """Yield numbers of topics, times, ns, and messages by time.

    Args:
        database: that is opened.
        at_once: messages.
    """
    import pyarrow as pa
    from adbc_driver_sqlite import StatementOptions

    kinds = pa.schema({"topic_id": pa.int64(), "timestamp": pa.int64(), "data": pa.binary()})
    with database.cursor() as cursor:
        cursor.adbc_statement.set_options(**{StatementOptions.BATCH_ROWS.value: str(at_once)})
        cursor.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp")
        for batch in cursor.fetch_record_batch():
            which, times, data = batch.cast(kinds).columns
            yield which.to_numpy(), times.to_numpy(), Packed.of_arrow(data)
