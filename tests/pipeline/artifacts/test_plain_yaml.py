"""A person's YAML: numbers are numbers, and a file of a stranger is bounded."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from omegaconf import OmegaConf

from simgap.artifacts.plain_yaml import read_yaml
from simgap.errors import InputError


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5e-05", 5e-5),
        ("5E-05", 5e-5),
        ("-5e5", -5e5),
        ("+5e5", 5e5),
        (".5e-3", 5e-4),
        ("1.e-3", 1e-3),
        ("1.5e5", 1.5e5),
        ("5.0e-05", 5e-5),
        ("0.25", 0.25),
    ],
)
def test_a_number_in_scientific_notation_is_a_number(text, value, tmp_path):
    (tmp_path / "a.yaml").write_text(f"inertia: {text}\nlist: [{text}]\n")
    assert read_yaml(tmp_path / "a.yaml") == {"inertia": value, "list": [value]}


@pytest.mark.parametrize("text", ["5e", "e5", "0x1e5", "5e-05 kg", "'5e-05'", "1e5_", "v1e5", "--1e5"])
def test_text_stays_text(text, tmp_path):
    (tmp_path / "a.yaml").write_text(f"a: {text}\n")
    value = read_yaml(tmp_path / "a.yaml")["a"]
    assert isinstance(value, str) or value == 0x1E5


@given(value=st.floats(allow_nan=False, allow_infinity=False))
def test_every_number_that_python_prints_is_read_as_hydra_reads_it(value, tmp_path_factory):
    path = tmp_path_factory.mktemp("numbers") / "a.yaml"
    path.write_text(f"a: {value!r}\n")
    read = read_yaml(path)["a"]
    assert read == value
    assert OmegaConf.load(path)["a"] == read


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (b"a: [", "is not plain YAML"),
        (b"a: !!python/object/apply:os.system [id]", "is not plain YAML"),
        (b"a: 2024-13-45", "is not plain YAML"),
        (b"\xff\xfe", "is not plain YAML"),
        (b"[" * 2_000, "is not plain YAML"),
        (b"a: 1\n" * 300_000, "is larger than 1 MB"),
        (b"a: &a [*a, *a]", "holds more than 100000 values"),
        ("\n".join(["a0: &a0 [1]"] + [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 9)]).encode(),
         "holds more than 100000 values"),
    ],
    ids=["syntax", "object", "date", "encoding", "deep", "large", "circle", "aliases"],
)  # fmt: skip
def test_a_hostile_file_is_refused_in_one_line(content, line, tmp_path):
    (tmp_path / "a.yaml").write_bytes(content)
    with pytest.raises(InputError) as refused:
        read_yaml(tmp_path / "a.yaml")
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


def test_infinity_is_left_to_who_reads_the_key(tmp_path):
    (tmp_path / "a.yaml").write_text("a: .inf\n")
    assert math.isinf(read_yaml(tmp_path / "a.yaml")["a"])
