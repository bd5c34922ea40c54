"""Archives of numpy arrays: columns by their length, nothing executed, nothing believed that is not there."""

import contextlib
import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.formats import read_log


def archive(path: Path, **arrays: np.ndarray) -> Path:
    np.savez_compressed(path, **arrays)
    return path


def test_arrays_of_n_rows_are_columns(tmp_path: Path) -> None:
    time = np.arange(5) / 10
    path = archive(
        tmp_path / "log.npz", time=time, q=np.arange(15.0).reshape(5, 3), pose=np.zeros((5, 2, 2)), kp=np.array(4.0),
        other=np.zeros(99), flag=np.array([True, False, True, True, True]), big=np.asfortranarray(np.eye(5)),
    )  # fmt: skip
    log = read_log(path)
    np.testing.assert_array_equal(log.signals["q[2]"].values, [2, 5, 8, 11, 14])
    np.testing.assert_array_equal(log.signals["big[1]"].values, [0, 1, 0, 0, 0])
    assert {"time", "pose[1][0]", "flag"} <= set(log.signals)
    assert log.facts["kp"] == "4.0"
    assert "other" in log.remarks[0]


def test_objects_are_left_out_and_never_loaded(tmp_path: Path) -> None:
    class Harmful:
        def __reduce__(self):  # type: ignore[no-untyped-def]
            return (Path.touch, (tmp_path / "executed",))

    path = archive(tmp_path / "log.npz", t=np.arange(4.0), bad=np.array([Harmful()] * 4, dtype=object))
    log = read_log(path)
    assert set(log.signals) == {"t"}
    assert "bad" in log.remarks[0]
    assert not (tmp_path / "executed").exists()


def test_a_header_that_promises_more_than_there_is(tmp_path: Path) -> None:
    content = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        content, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
    )
    path = tmp_path / "log.npz"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("t.npy", content.getvalue() + bytes(80))
    with pytest.raises(InputError, match="damaged archive"):
        read_log(path)


@pytest.mark.parametrize("arrays", [{}, {"a": np.array(3.0)}, {"a": np.array(["x", "y"])}])
def test_without_samples_it_is_refused(tmp_path: Path, arrays: dict[str, np.ndarray]) -> None:
    with pytest.raises(InputError, match="no arrays with samples"):
        read_log(archive(tmp_path / "log.npz", **arrays))


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(position=st.integers(0, 2000), value=st.integers(0, 255), end=st.integers(1, 2000))
def test_damage_is_told_in_one_line(tmp_path: Path, position: int, value: int, end: int) -> None:
    path = archive(tmp_path / "log.npz", t=np.arange(20.0), q=np.arange(40.0).reshape(20, 2))
    content = bytearray(path.read_bytes())
    content[position % len(content)] = value
    path.write_bytes(bytes(content[: len(content) if end % 2 else end % len(content) + 1]))
    with contextlib.suppress(InputError):  # anything else fails
        read_log(path)
