"""Texts that are the same but for their numbers: what is found in them is what a parser finds; others are refused."""

import json
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap import compiled
from simgap.recordings.alike_texts import between_numbers, numbers_alike
from tests.pipeline.logs.damage import damaged

NUMBERS = st.integers(-(2**70), 2**70) | st.floats(allow_nan=False, allow_infinity=False)
ROWS = st.integers(0, 4).flatmap(
    lambda width: st.lists(st.lists(NUMBERS, min_size=width, max_size=width), min_size=1, max_size=8)
)


def numbers_of(texts: list[bytes], gap: bytes = b"") -> Any:
    """Return the numbers of texts that lie behind one another."""
    sizes = np.array([len(text) for text in texts])
    begins = np.cumsum(sizes + len(gap)) - sizes
    buffer = np.frombuffer(gap + gap.join(texts), dtype=np.uint8)
    return numbers_alike(buffer, begins, sizes, between_numbers(texts[0]))


def bits(values: Any) -> list[bytes]:
    """Return numbers so that 0 and -0 differ."""
    return [struct.pack("<d", value) for value in np.ravel(values)]


@pytest.fixture(autouse=True, params=[True, False], ids=["compiled", "plain"])
def _loop(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if not request.param:
        monkeypatch.setattr(compiled, "for_size", lambda loop, size: loop)


@given(rows=ROWS, gap=st.sampled_from([b"", b"12"]))
def test_every_number_is_the_one_that_is_written(rows: list[list[float]], gap: bytes) -> None:
    texts = [json.dumps({"x1": 'a "7"', "values": row, "last": 5}).encode() for row in rows]
    np.testing.assert_array_equal(
        bits(numbers_of(texts, gap)), bits([[*map(float, row), 5.0] for row in rows])
    )


def test_texts_without_numbers_have_none() -> None:
    assert numbers_of([b'{"a": "1"}'] * 3).shape == (3, 0)
    assert numbers_of([b'{"a": "1"}', b'{"a": "2"}']) is None


@pytest.mark.parametrize("written", ["0", "-1", "0.5", "-0.0", "1e5", "1E+05", "-2.50e-3", "10", "1e999"])
def test_numbers_of_json_are_read(written: str) -> None:
    assert bits(numbers_of([b"[1, 2]", f"[1, {written}]".encode()])) == bits([1.0, 2.0, 1.0, float(written)])


@pytest.mark.parametrize(
    "written",
    ["", "-", "01", "-01", ".5", "1.", "+1", "1e", "1e+", "1.e5", "0x1", "1_0", "NaN", "Infinity", "-0", " 1",
     '"1"', "true", "null", "[1]", "1, 1"],
)  # fmt: skip
def test_anything_else_is_refused(written: str) -> None:
    assert numbers_of([b"[1, 2]", f"[1, {written}]".encode()]) is None


@given(data=st.data())
def test_what_is_read_of_damaged_texts_is_what_a_parser_reads(data: st.DataObject) -> None:
    sound = b'{"a": -0.25, "b": [1e-3, 17]}'
    text = data.draw(damaged(sound))
    found = numbers_of([sound, text])
    if found is not None:
        content = json.loads(text)
        assert bits(found[1]) == bits([content["a"], *content["b"]])
