import hashlib
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as some

from simgap.artifacts import hash_path, hash_value
from simgap.errors import InputError


def test_a_file_is_known_by_its_sha256(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"content")
    assert hash_path(path) == hashlib.sha256(b"content").hexdigest()


def tree(root: Path, **files: str) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return root


def test_a_tree_is_known_by_names_and_contents_only(tmp_path: Path) -> None:
    first = tree(tmp_path / "first", a="1", b="2")
    second = tree(tmp_path / "second", b="2", a="1")
    os.utime(second / "a", (0, 0))
    assert hash_path(first) == hash_path(second)
    assert hash_path(tree(tmp_path / "swapped", a="2", b="1")) != hash_path(first)
    assert hash_path(tree(tmp_path / "renamed", a="1", c="2")) != hash_path(first)
    assert hash_path(tree(tmp_path / "joined", a="1b2")) != hash_path(first)


def test_what_is_not_there_is_said_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent: cannot be read \(No such file or directory\)"):
        hash_path(tmp_path / "absent")


@given(some.dictionaries(some.text(), some.integers() | some.text() | some.booleans() | some.none()))
def test_a_value_is_known_in_any_order_of_keys(value: dict) -> None:
    assert hash_value(value) == hash_value(dict(reversed(value.items())))
    assert hash_value(value) != hash_value({**value, "one more key": 1})
