import pytest
import torch

from simgap.artifacts import hash_path
from simgap.artifacts.descriptions import (
    read_description,
    read_tensors,
    write_description,
    write_tensors,
)
from simgap.errors import InputError

TENSORS = {"second": torch.arange(6.0).reshape(2, 3).T, "first": torch.ones(2)}


def test_numbers_are_read_as_they_were_written_whatever_their_order(tmp_path):
    described = write_tensors(TENSORS, tmp_path / "numbers")
    read = read_tensors(tmp_path / "numbers", described, "make it again")
    assert all(torch.equal(read[name], tensor) for name, tensor in TENSORS.items())
    turned = {name: TENSORS[name] for name in reversed(TENSORS)}
    assert write_tensors(turned, tmp_path / "again")["sha256"] == described["sha256"]


def test_a_description_keeps_its_order(tmp_path):
    write_description({"schema": "simgap.x/1", "b": 1, "a": "ü"}, tmp_path / "x.yaml")
    assert list(read_description(tmp_path / "x.yaml", "simgap.x/1", "", "")) == ["schema", "b", "a"]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "cannot be read.*give a folder"),
        (b"[", "is not plain YAML; make it again"),
        (b"!!python/object/apply:os.getcwd []", "is not plain YAML"),
        (b"\xff\xfe", "is not plain YAML"),
        (b"- 1", "is not of schema simgap.x/1"),
        (b"schema: simgap.x/2", "is not of schema simgap.x/1; make it again"),
    ],
)
def test_what_is_no_description_is_refused_in_one_line(tmp_path, content, message):
    path = tmp_path / "x.yaml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_description(path, "simgap.x/1", "give a folder", "make it again")
    assert "\n" not in str(caught.value)


def test_other_numbers_than_described_are_refused(tmp_path):
    file = tmp_path / "numbers"
    with pytest.raises(InputError, match="belongs to; make it again"):
        read_tensors(file, {"sha256": "0"}, "make it again")
    described = write_tensors(TENSORS, file)
    with pytest.raises(InputError, match="belongs to"):
        read_tensors(file, "nothing that was described", "make it again")
    whole = file.read_bytes()
    for damaged in (whole[:-1], b"", whole + b"\0"):
        file.write_bytes(damaged)
        with pytest.raises(InputError, match="belongs to"):
            read_tensors(file, described, "make it again")


def test_a_file_that_is_described_and_yet_no_safetensors_is_refused(tmp_path):
    file = tmp_path / "numbers"
    file.write_bytes(b"\x80\x04.")
    with pytest.raises(InputError, match="is not a safetensors file"):
        read_tensors(file, {"sha256": hash_path(file)}, "make it again")
