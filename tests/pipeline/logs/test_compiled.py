"""Loops over the bytes of a file: compiled they find what Python finds, in sound files and in damaged ones."""

import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap import compiled
from simgap.errors import InputError
from simgap.logs.formats import read_log
from simgap.logs.readers.mcap_records import messages
from tests.pipeline.logs.bag_writer import ROS2, write_json, write_ros2
from tests.pipeline.logs.damage import damaged
from tests.pipeline.logs.test_bag import swinging
from tests.pipeline.logs.test_crazyflie import TWO, encoded
from tests.pipeline.logs.test_ulog import CONTENT
from tests.pipeline.logs.ulog_encoder import message


def test_few_bytes_are_left_to_python() -> None:
    assert compiled.for_size(messages, compiled.LARGE - 1) is messages
    assert compiled.for_size(messages, compiled.LARGE) is not messages


@pytest.fixture(scope="module")
def contents(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Return a log of each format whose loop can be compiled, by the ending of its name."""
    bag = write_ros2(tmp_path_factory.mktemp("bag") / "cdr", swinging(ROS2), mcap=True)
    states = (("/joint", 0.01 * n, {"name": ["elbow"], "position": [0.1 * n]}) for n in range(50))
    text = write_json(tmp_path_factory.mktemp("text") / "text.mcap", states)
    checked, cut = encoded(TWO), encoded(TWO, checksum=False)
    bags = {".mcap": (bag / "cdr.mcap").read_bytes(), ".text.mcap": text.read_bytes()}
    return {".ulg": CONTENT, ".bin": checked, ".cut.bin": cut} | bags


def _told(path: Path) -> list[object]:
    """Return all that a log says, or the one line that refuses it."""
    try:
        log = read_log(path)
    except InputError as error:
        return [str(error)]
    signals = [(name, signal.time.tobytes(), signal.values.tobytes()) for name, signal in log.signals.items()]
    return [*signals, log.remarks, log.spans, dict(log.facts)]


@pytest.mark.parametrize("suffix", [".ulg", ".mcap", ".text.mcap", ".bin", ".cut.bin"])
@settings(max_examples=30)
@given(data=st.data())
def test_compiled_and_plain_loops_read_the_same(
    tmp_path_factory: pytest.TempPathFactory, contents: dict[str, bytes], suffix: str, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / f"log{suffix}"
    path.write_bytes(data.draw(st.just(contents[suffix]) | damaged(contents[suffix])))
    plain = _told(path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "LARGE", 0)
        assert _told(path) == plain


def _plain_places(content: bytes) -> list[int]:
    """Return where the messages of MCAP begin that follow each other from the first byte."""
    place, found = 0, []
    while len(content) - place >= 9:
        kind, size = struct.unpack_from("<BQ", content, place)
        if kind != 5 or place + 9 + size > len(content):
            break
        found.append(place)
        place += 9 + size
    return found


@given(
    sizes=st.lists(st.integers(0, 40)),
    end=st.sampled_from(
        [b"", b"\x05", b"\x07" + bytes(8), b"\x05" + b"\xff" * 8, b"\x05" + b"\xff" * 7 + b"\x7f"]
    ),
    cut=st.integers(0, 40),
)
def test_messages_end_at_another_record_or_at_what_is_cut_off(sizes: list[int], end: bytes, cut: int) -> None:
    content = b"".join(struct.pack("<BQ", 5, size) + bytes(size) for size in sizes) + end
    content = content[: max(0, len(content) - cut)]
    for loop in (messages, compiled.for_size(messages, compiled.LARGE)):
        places = np.empty(len(sizes) + 1, dtype=np.int64)
        found, _ = loop(np.frombuffer(content, dtype=np.uint8).data, 0, 0, places.data)
        assert places[:found].tolist() == _plain_places(content)


def _peak(read: Callable[[], object]) -> int:
    tracemalloc.start()
    try:
        read()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "tail",
    [
        message("D", b"") * 100_000,
        message("S", b"\0") * 100_000,
        message("D", struct.pack("<HQf", 0, 0, 0.0)) * 30_000,
        b"\0" * 400_000,
    ],
    ids=["empty records", "marks", "records", "nothing"],
)
def test_memory_is_bounded_by_the_file(tmp_path: Path, tail: bytes) -> None:
    path = tmp_path / "log.ulg"
    path.write_bytes(CONTENT + tail)
    read_log(path)  # what is imported late is there
    assert _peak(lambda: read_log(path)) < 16 * path.stat().st_size
