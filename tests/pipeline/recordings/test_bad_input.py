"""Every hopeless input is refused in one line that names where and what to do."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from simgap.errors import InputError
from simgap.recordings import read_recording


def refused(path, *words: str) -> str:
    """Read, and return the one line of the refusal, in which every word must stand."""
    with pytest.raises(InputError) as caught:
        read_recording(path)
    message = str(caught.value)
    assert "\n" not in message
    for word in (str(path), *words):
        assert word in message
    return message


@pytest.fixture
def written(frames, tmp_path):
    """Return a function that changes a good frame, writes it and returns the path."""

    def write(change=lambda frame: frame, kind="joint", suffix="parquet"):
        frame = change(frames(kind).astype({"run": object}))
        path = tmp_path / f"bad.{suffix}"
        frame.to_csv(path, index=False) if suffix == "csv" else frame.to_parquet(path)
        return path

    return write


def _set(row, column, value):
    def change(frame):
        frame = frame.astype({column: object}) if isinstance(value, str) else frame
        frame.loc[row, column] = value
        return frame

    return change


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_empty_file(tmp_path, suffix):
    path = tmp_path / f"empty.{suffix}"
    path.touch()
    refused(path, "is empty")


def test_not_parquet(tmp_path):
    path = tmp_path / "notes.parquet"
    path.write_text("these are my notes")
    refused(path, "not a Parquet file")


def test_truncated_parquet(written):
    path = written()
    path.write_bytes(path.read_bytes()[:500])
    refused(path, "damaged Parquet")


def test_missing_file_and_folder(tmp_path):
    refused(tmp_path / "nowhere.parquet", "does not exist")
    refused(tmp_path, "is a folder")


def test_file_without_permission(written, monkeypatch):
    path = written()

    def deny(*_arguments, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.open", deny)
    refused(path, "Permission denied", "permissions")


def test_csv_that_is_no_text(tmp_path):
    path = tmp_path / "binary.csv"
    path.write_bytes(bytes(range(128, 256)))
    refused(path, "not a text file")


def test_csv_without_names(tmp_path):
    path = tmp_path / "bare.csv"
    path.write_text("0,1,2\n0.1,1,2\n")
    refused(path, "row of names")


def test_csv_with_ragged_rows(tmp_path):
    path = tmp_path / "ragged.csv"
    path.write_text("run,t,position\na,0,1\na,1,2,3,4\n")
    refused(path, "line 3")


def test_csv_with_more_cells_than_names(tmp_path):
    path = tmp_path / "wide.csv"
    path.write_text("run,t,position\na,0,1,7\na,1,2,7\n")
    refused(path, "more columns than the header")


def test_repeated_column(tmp_path):
    path = tmp_path / "twice.csv"
    path.write_text("run,t,t\na,0,1\n")
    refused(path, "'t'", "twice")
    table = pa.table([["a"], [0.0], [1.0]], names=["run", "t", "t"])
    pq.write_table(table, tmp_path / "twice.parquet")
    refused(tmp_path / "twice.parquet", "'t'", "twice")


def test_header_without_samples(written):
    refused(written(lambda frame: frame.iloc[:0], suffix="csv"), "no samples")


@pytest.mark.parametrize("column", ["run", "t", "position", "steer_velocity_1"])
def test_missing_column(written, column):
    kind = "swerve" if column.startswith("steer") else "joint"
    refused(written(lambda frame: frame.drop(columns=column), kind), repr(column), "missing")


def test_missing_column_with_its_nearest_name(written):
    path = written(lambda frame: frame.rename(columns={"position": "Positoin"}))
    refused(path, "'position' is missing", "did you mean 'Positoin'?")
    path = written(lambda frame: frame.rename(columns={"velocity": "Velocty"}))
    (remark,) = read_recording(path).warnings
    assert "'Velocty' is unknown for a joint (did you mean 'velocity'?)" in remark


def test_missing_group(written):
    refused(written(lambda frame: frame.drop(columns="voltage")), "effort or voltage or position_command")
    path = written(lambda frame: frame.drop(columns="motor_speed_3"), "quadrotor")
    refused(path, "'motor_speed_3' is missing")


def test_no_column_of_a_recording(tmp_path):
    path = tmp_path / "other.csv"
    path.write_text("time,angle\n0,1\n")
    refused(path, "time, angle", "docs/contract.md")


@pytest.mark.parametrize(
    ("unit", "words"), [("furlong", "unknown unit 'furlong'"), ("V", "unit 'V' does not fit")]
)
def test_units(frames, tmp_path, unit, words):
    table = pa.Table.from_pandas(frames(), preserve_index=False)
    index = table.schema.get_field_index("position")
    schema = table.schema.set(index, table.schema.field(index).with_metadata({"unit": unit}))
    pq.write_table(table.cast(schema), tmp_path / "a.parquet")
    refused(tmp_path / "a.parquet", "column 'position'", words)


def test_unknown_kind(frames, tmp_path):
    table = pa.Table.from_pandas(frames(), preserve_index=False).replace_schema_metadata(
        {"platform_kind": "boat"}
    )
    pq.write_table(table, tmp_path / "a.parquet")
    refused(tmp_path / "a.parquet", "'boat'", "quadrotor")


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_set(204, "t", 0.005), ("run 'run1'", "row 205", "column 't'", "time goes back")),
        (_set(204, "t", 0.03), ("run 'run1'", "row 205", "column 't'", "same time appears twice")),
        (_set(204, "t", np.nan), ("run 'run1'", "row 205", "no time")),
        (_set(7, "velocity", np.inf), ("run 'run0'", "row 8", "column 'velocity'", "infinity")),
        (_set(7, "velocity", 3e300), ("run 'run0'", "row 8", "column 'velocity'", "3e+300")),
        (_set(7, "run", None), ("row 8", "column 'run'")),
    ],
)
def test_bad_samples(written, suffix, change, words):
    refused(written(change, suffix=suffix), *words)


def test_text_in_a_number(written, frames, tmp_path):
    refused(written(_set(7, "velocity", "fast"), suffix="csv"), "run 'run0'", "row 8", "'velocity'", "'fast'")
    path = tmp_path / "text.parquet"
    frames().assign(velocity="fast").to_parquet(path)
    refused(path, "run 'run0'", "row 1", "'velocity'", "'fast'")


def test_dates_are_no_seconds(frames, tmp_path):
    frame = frames().assign(t=lambda table: pd.to_datetime(table["t"], unit="s"))
    frame.to_parquet(tmp_path / "dates.parquet")
    refused(tmp_path / "dates.parquet", "column 't'", "datetime64")


@pytest.mark.parametrize("column", ["position", "voltage"])
def test_required_channel_without_values(written, column):
    refused(written(lambda frame: frame.assign(**{column: np.nan})), repr(column), "no values")


def test_quaternion_of_half_the_length(written):
    quaternion = [f"attitude_{axis}" for axis in "wxyz"]

    def halve(frame):
        frame.loc[300:, quaternion] /= 2
        return frame

    refused(written(halve, "quadrotor"), "run 'run1'", "row 301", "norm is 0.5")
