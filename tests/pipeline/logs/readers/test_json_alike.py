"""Messages in JSON read at once: what one parser tells, the other one tells."""

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.logs.readers import json_alike, json_messages
from simgap.logs.readers.json_alike import columns_alike
from simgap.logs.readers.json_messages import json_columns
from simgap.logs.readers.packed import Columns, Packed
from tests.pipeline.logs.damage import damaged


def packed(*contents: Any) -> Packed:
    return Packed.of([each if isinstance(each, bytes) else json.dumps(each).encode() for each in contents])


def one_by_one(messages: Packed, monkeypatch: pytest.MonkeyPatch) -> list[Columns]:
    with monkeypatch.context() as patch:
        patch.setattr(json_messages, "columns_alike", lambda messages, large: None)
        return list(json_messages.json_columns(messages))


def assert_same(one: Columns, other: Columns) -> None:
    np.testing.assert_array_equal(one.rows, other.rows)
    for (names, values), (expected, wanted) in zip(one.blocks, other.blocks, strict=True):
        assert names == expected
        np.testing.assert_array_equal(values, wanted)
    assert one.long == other.long
    assert (one.stamps is None) == (other.stamps is None)
    if one.stamps is not None:
        np.testing.assert_array_equal(one.stamps, other.stamps)


STATE = {
    "name": ["elbow", "wrist"],
    "position": [0.1, 2],
    "deep": {"on": True, "list": [{"x": 1}, {"x": 2.5}]},
}


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"header": {"stamp": {"sec": 17, "nanosec": 5}, "frame_id": "world"}},
        {"stamp": 1.7e9 + 0.123456789},
        {"note": "on 2026-01-01", "scan": list(range(101))},
        {"huge": 12345678901234567890, "small": 1e-300},
    ],
)
@pytest.mark.parametrize("large", [False, True])
def test_both_parsers_tell_the_same(
    more: dict[str, Any], large: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    messages = packed(*(STATE | more | {"count": count, "value": 0.1 * count} for count in range(5)))
    found = columns_alike(messages, large)
    assert found is not None
    (expected,) = one_by_one(messages, monkeypatch)
    assert_same(found, expected)


@pytest.mark.parametrize(
    "other",
    [
        {"name": ["wrist", "elbow"], "position": [0.1, 2.0]},
        {"name": ["elbow", "wrist"], "position": [0.1]},
        {"name": ["elbow", "wrist"], "position": [0.1, "far"]},
        {"name": ["elbow", "wrist"]},
        b'{"name": ["elbow", "wrist"], "position": [0.1, ',
        b'{"a":' * 5000,
        b"",
        b"[1, 2]",
        b'{"name": ["elbow", "wrist"],\n"position": [0.1, 2.0]}',
    ],
)
@pytest.mark.parametrize("large", [False, True])
def test_messages_that_are_not_alike_are_left_to_the_slower_reader(other: Any, large: bool) -> None:
    messages = packed({"name": ["elbow", "wrist"], "position": [0.1, 2.0]}, other)
    assert columns_alike(messages, large) is None
    assert sum(len(part.rows) for part in json_messages.json_columns(messages)) in (1, 2)


numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**60), 2**60) | st.booleans()


UNSTAMPED = {"name": ["elbow", "wrist"], "position": [0.1, 2], "note": 'at "7"', "deep": [{"x": -1e-3}]}


def test_messages_that_differ_in_their_numbers_only_need_no_parser(monkeypatch: pytest.MonkeyPatch) -> None:
    messages = packed(*(UNSTAMPED | {"count": count} for count in range(5)))
    (expected,) = one_by_one(messages, monkeypatch)
    assert columns_alike(messages, large=True) is not None  # the example is parsed
    monkeypatch.setattr(json_alike, "_parsed", lambda messages: None)
    found = columns_alike(messages, large=True)
    assert found is not None
    assert_same(found, expected)


@given(data=st.data())
def test_damaged_messages_are_read_as_before(data: st.DataObject) -> None:
    text = json.dumps(UNSTAMPED).encode()
    messages = packed(text, data.draw(damaged(text)), text)
    for found, expected in zip(
        json_columns(messages, large=True), json_columns(messages, large=False), strict=True
    ):
        assert_same(found, expected)


@settings(deadline=None, max_examples=40)
@given(st.lists(numbers, min_size=1, max_size=4))
def test_every_number_survives(values: list[float]) -> None:
    found = columns_alike(packed({"values": [float(value) for value in values]}))
    assert found is not None
    np.testing.assert_array_equal(found.blocks[0][1][0], [float(value) for value in values])


@given(sizes=st.lists(st.integers(0, 30), max_size=20), gap=st.sampled_from([0, 3, 500]), order=st.randoms())
def test_messages_are_cut_out_wherever_they_lie(sizes: list[int], gap: int, order: Any) -> None:
    buffer = np.random.default_rng(0).integers(0, 256, sum(sizes) + gap * len(sizes) + 1, dtype=np.uint8)
    begins = [sum(sizes[:place]) + gap * place for place in range(len(sizes))]
    chosen = list(zip(begins, sizes, strict=True))
    order.shuffle(chosen)
    at, long = (np.array([each[part] for each in chosen], dtype=np.int64) for part in (0, 1))
    found = Packed(buffer, at, long).texts()
    assert found == [buffer[begin : begin + size].tobytes() for begin, size in chosen]
