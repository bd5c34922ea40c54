"""Tables as JSON, in the shapes in which scripts write them."""

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.formats import read_log
from simgap.logs.log import Log

RECORDS = [{"t": 0.0, "q": 1, "on": True}, {"t": 0.1, "q": None, "on": False}, {"t": 0.2, "q": 3, "on": True}]


def log_of(tmp_path: Path, content: object, name: str = "log.json") -> Log:
    path = tmp_path / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return read_log(path)


@pytest.mark.parametrize(
    "content",
    [
        RECORDS,
        {"mass": 2, "entries": RECORDS},
        {name: [record[name] for record in RECORDS] for name in RECORDS[0]},
        {"meta": {"rate": 10}, "data": {name: [record[name] for record in RECORDS] for name in RECORDS[0]}},
    ],
)
def test_records_and_lists(tmp_path: Path, content: object) -> None:
    log = log_of(tmp_path, content)
    np.testing.assert_allclose(log.signals["t"].values, [0, 0.1, 0.2])
    np.testing.assert_array_equal(log.signals["q"].values, [1, 3])
    np.testing.assert_array_equal(log.signals["q"].time, [0, 2])
    np.testing.assert_array_equal(log.signals["on"].values, [1, 0, 1])


def test_one_record_a_line(tmp_path: Path) -> None:
    log = log_of(tmp_path, "\n".join(json.dumps(record) for record in RECORDS), "log.jsonl")
    assert len(log.signals["t"].time) == 3


def test_what_stands_beside_the_table_is_a_fact(tmp_path: Path) -> None:
    log = log_of(tmp_path, {"mass": 2, "config": {"hz": 50}, "entries": RECORDS})
    assert dict(log.facts) == {"mass": "2", "config.hz": "50"}


def test_nested_records_and_arrays(tmp_path: Path) -> None:
    records = [{"header": {"stamp": k}, "position": [k, 2 * k]} for k in range(3)]
    log = log_of(tmp_path, records)
    np.testing.assert_array_equal(log.signals["position[1]"].values, [0, 2, 4])
    np.testing.assert_array_equal(log.signals["header.stamp"].values, [0, 1, 2])


def test_a_list_of_runs(tmp_path: Path) -> None:
    runs = [{"kind": "a", "q": [1, 2, 3], "u": [0, 0, 0]}, {"kind": "b", "q": [4, 5], "u": [1, 1]}]
    log = log_of(tmp_path, {"data": runs})
    np.testing.assert_array_equal(log.signals["run"].values, [1, 1, 1, 2, 2])
    np.testing.assert_array_equal(log.signals["q"].values, [1, 2, 3, 4, 5])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("{", "is not JSON"),
        ("[" * 100_000, "is not JSON"),
        ("3", "holds no table"),
        ('{"a": "b"}', "holds no table"),
        ("[]", "holds no"),
    ],
)
def test_what_is_no_table_is_refused(tmp_path: Path, content: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        log_of(tmp_path, content)


def _json(depth: int) -> st.SearchStrategy[object]:
    leaves = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3)
    return st.recursive(
        leaves,
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=2), inner, max_size=4),
    )


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(content=_json(3))
def test_any_document_is_a_log_or_one_line(tmp_path: Path, content: object) -> None:
    with contextlib.suppress(InputError):  # anything else fails
        log_of(tmp_path, content)


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(position=st.integers(0, 300), value=st.integers(0, 255), end=st.integers(1, 300))
def test_damage_is_told_in_one_line(tmp_path: Path, position: int, value: int, end: int) -> None:
    content = bytearray(json.dumps({"mass": 2, "entries": RECORDS}).encode())
    content[position % len(content)] = value
    path = tmp_path / "log.json"
    path.write_bytes(bytes(content[: len(content) if end % 2 else end % len(content) + 1]))
    with contextlib.suppress(InputError):  # anything else fails
        read_log(path)
