"""A large SysId file whose rows are alike is what Python's parser makes of it; what is unusual is left to that."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap import compiled
from simgap.errors import InputError
from simgap.recordings.importers import sysid_json
from simgap.recordings.importers.sysid_alike import content_of_rows
from tests.pipeline.logs.damage import damaged

NUMBERS = st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False)
TABLES = st.integers(1, 9).flatmap(
    lambda width: st.lists(
        st.lists(st.lists(NUMBERS, min_size=width, max_size=width), min_size=2, max_size=9), min_size=1, max_size=4
    )
)  # fmt: skip
HEAD = {"sysid": True, "test": "Simple", "units": "Rotations", "unitsPerRotation": 1.0}
TEXT = json.dumps(HEAD | {"slow-forward": [[0.02 * n, 1.5, 0.1 * n, -7e-3] for n in range(9)]}).encode()


@pytest.fixture(autouse=True)
def _every_file_is_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "LARGE", 1)


@given(tables=TABLES, indent=st.sampled_from([None, 2]), first=st.booleans())
def test_the_numbers_are_the_same(
    tmp_path_factory: pytest.TempPathFactory, tables: list, indent: int | None, first: bool
) -> None:
    path = tmp_path_factory.getbasetemp() / "sysid.json"
    rows = dict(zip(sysid_json.TESTS, tables, strict=False))
    path.write_text(json.dumps(rows | HEAD if first else HEAD | rows, indent=indent))
    found = content_of_rows(path)
    assert found is not None
    assert list(found) == list(json.loads(path.read_text()))
    for name, table in rows.items():
        np.testing.assert_array_equal(found.pop(name), np.array(table, dtype=float))
    assert found == HEAD


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "[[1, 2], [3, 4]]",
        '{"slow-forward": [[1, 2]]}',
        '{"slow-forward": [[1, 2], [3]]}',
        '{"slow-forward": [[1, 2], [3, 4, 5]]}',
        '{"slow-forward": [[1, 2], [3, 4], ]}',
        '{"slow-forward": [[1, 2],, [3, 4]]}',
        '{"slow-forward": [[1, 2] [3, 4]]}',
        '{"slow-forward": [[1, 2,], [3, 4,]]}',
        '{"slow-forward": [[], []]}',
        '{"slow-forward": [["a"], ["a"]]}',
        '{"slow-forward": [[1, null], [2, null]]}',
        '{"slow-forward": [[1, true], [2, true]]}',
        '{"slow-forward": [[[1]], [[2]]]}',
        '{"slow-forward": [[1, 2], [3, 4]]',
        '{"slow-forward": [[1, 2], [3, 4]',
        '{"slow-forward": [[1, 2], [3, 4',
        '{"slow-forward": [[1, 2], [3, 4]]]}',
        '{"slow-forward": [[1, 2], [[3, 4]]}',
        '{"slow-forward": [[1, 2],\f[3, 4],\f[5, 6]]}',
        '{"slow-forward": [[1, 2], [3, 4]], "slow-forward": [[1, 2], [3, 4]]}',
        '{"slow-forward": [[1, 2], [3, 4]], "slow-backward": []}',
        '{"slow-forward": [[1, 2], [3, 4]], "slow-backward": [1, 2]}',
        '{"slow-forward": {"a": [[1, 2], [3, 4]]}}',
        '{"a": "\\": [[1, 2], [3, 4]]"}',
        '{"a": ' + "[" * 100_000 + "]" * 100_000 + "}",
    ],
)
def test_anything_unusual_is_left_to_the_other_parser(tmp_path: Path, text: str) -> None:
    path = tmp_path / "sysid.json"
    path.write_text(text)
    assert content_of_rows(path) is None


def _loaded(path: Path) -> object:
    try:
        content = sysid_json.load(path)
    except InputError as error:
        return str(error)
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in content.items()}


@given(data=st.data())
def test_damaged_files_are_read_or_refused_as_before(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "sysid.json"
    path.write_bytes(data.draw(st.just(TEXT) | damaged(TEXT)))
    found = _loaded(path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sysid_json, "content_of_rows", lambda path: None)
        assert _loaded(path) == found
