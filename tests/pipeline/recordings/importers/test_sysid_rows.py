"""A SysId file by Arrow's parser is what Python's parser makes of it; what is unusual is left to that."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.recordings.importers.sysid_rows import content_by_arrow

NUMBERS = st.one_of(st.integers(-(2**53), 2**53), st.floats())
ROWS = st.integers(1, 9).flatmap(
    lambda width: st.lists(st.lists(NUMBERS, min_size=width, max_size=width), min_size=1, max_size=20)
)


@given(rows=ROWS, indent=st.sampled_from([None, 2]))
def test_the_numbers_are_the_same(rows: list, indent: int | None) -> None:
    content = {"sysid": True, "units": "Rotations", "unitsPerRotation": 1.0, "slow-forward": rows}
    found = content_by_arrow(json.dumps(content, indent=indent).encode())
    assert found is not None
    np.testing.assert_array_equal(found.pop("slow-forward"), np.array(rows, dtype=float))
    assert found == {key: content[key] for key in found}


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"[]",
        b'{"slow-forward": [[1, 2], [3]]}',
        b'{"slow-forward": [[1, "a"]]}',
        b'{"slow-forward": [[1, null]]}',
        b'{"slow-forward": [1, 2]}',
        b'{"slow-forward": []}',
        b'{"slow-forward": [[]]}',
        b'{"slow-forward": [[[1]]]}',
        b'{"test": "2026-01-02", "slow-forward": [[1, 2]]}',
        b'{"slow-forward": [[1, 2]]',
        b'{"slow-forward": {"a": [[1, 2]]}}',
        b'{"a": 1}\n{"a": 2}',
        b"\xff\xfe{}",
        b'{"a": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
        b'{"a": "' + b"]" * 100_000 + b'", "b": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
    ],
)
def test_anything_unusual_is_left_to_the_other_parser(text: bytes) -> None:
    assert content_by_arrow(text) is None
