"""What is written is read again, bit for bit, and says the same in every format."""

import dataclasses
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.recordings import Recording, read_recording, require_kind, write_recording
from simgap.recordings.contract import KINDS, REQUIRED, channel_units
from simgap.recordings.recording import recording_from_frame


@pytest.mark.parametrize("kind", KINDS)
def test_round_trip(frames, tmp_path, kind):
    recording = recording_from_frame(frames(kind), kind)
    recording = dataclasses.replace(
        recording,
        source="a paper",
        licence="CC0",
        split={"run0": "train", "run1": "holdout"},
        clock_offset={"run0": 0.01},
        warnings=("one doubt; and “another”",),
    )
    write_recording(recording, tmp_path / "a.parquet")
    again = read_recording(tmp_path / "a.parquet")
    pd.testing.assert_frame_equal(again.frame, recording.frame)
    for field in ("kind", "units", "source", "licence", "split", "clock_offset", "warnings", "cleaned"):
        assert getattr(again, field) == getattr(recording, field)


@settings(max_examples=25, deadline=None)
@given(
    values=st.lists(st.floats(-1e6, 1e6) | st.just(float("nan")), min_size=3, max_size=12),
    run=st.text(st.characters(codec="utf-8", exclude_categories=["C"]), min_size=1, max_size=8),
)
def test_any_values_survive_and_give_the_same_bytes(tmp_path_factory, values, run):
    folder = tmp_path_factory.mktemp("round")
    frame = pd.DataFrame({"run": run, "t": np.arange(len(values)) * 0.1, "position": 0.5, "velocity": values})
    frame["voltage"] = 1.0
    frame.loc[0, "velocity"] = 0.25
    units = {column: unit for column, unit in channel_units("joint").items() if column in frame}
    write_recording(Recording(frame, "joint", units), folder / "a.parquet")
    again = read_recording(folder / "a.parquet")
    pd.testing.assert_frame_equal(again.frame, frame, check_dtype=False, check_exact=True)
    first = dataclasses.replace(again, warnings=())
    write_recording(first, folder / "b.parquet")
    assert (folder / "a.parquet").read_bytes() == (folder / "b.parquet").read_bytes()


def test_csv_says_the_same_as_parquet(frames, tmp_path):
    frame = frames("quadrotor")
    frame.to_csv(tmp_path / "a.csv", index=False)
    write_recording(recording_from_frame(frame, "quadrotor"), tmp_path / "a.parquet")
    from_csv, from_parquet = read_recording(tmp_path / "a.csv"), read_recording(tmp_path / "a.parquet")
    pd.testing.assert_frame_equal(from_csv.frame, from_parquet.frame, rtol=1e-12)
    assert from_csv.kind == from_parquet.kind == "quadrotor"


def test_every_field_carries_its_unit_and_the_file_its_kind(frames, tmp_path):
    write_recording(recording_from_frame(frames("joint"), "joint"), tmp_path / "a.parquet")
    schema = pq.read_schema(tmp_path / "a.parquet")
    units = {entry.name: (entry.metadata or {}).get(b"unit", b"").decode() for entry in schema}
    assert units == {"run": "", "t": "s", "position": "rad", "velocity": "rad/s", "voltage": "V"}
    assert schema.metadata[b"platform_kind"] == b"joint"


def _with_units(frame: pd.DataFrame, path: Path, **units: str) -> Path:
    table = pa.Table.from_pandas(frame, preserve_index=False)
    fields = [
        field.with_metadata({"unit": units[field.name]}) if field.name in units else field
        for field in table.schema.remove_metadata()
    ]
    pq.write_table(table.cast(pa.schema(fields)), path)
    return path


def test_declared_units_are_converted(frames, tmp_path):
    frame = frames("joint")
    foreign = frame.assign(
        t=frame["t"] * 1e3, position=np.degrees(frame["position"]), velocity=frame["velocity"] * 30 / np.pi
    )
    path = _with_units(foreign, tmp_path / "a.parquet", t="ms", position="deg", velocity="rpm", voltage="V")
    recording = read_recording(path)
    np.testing.assert_allclose(recording.frame.iloc[:, 1:], frame.iloc[:, 1:], atol=1e-12)
    assert recording.warnings == ()


def test_a_joint_in_millimetres_slides(frames, tmp_path):
    frame = frames("joint").rename(columns={"voltage": "effort"})
    path = _with_units(frame, tmp_path / "a.parquet", position="mm", velocity="mm/s", effort="N")
    recording = read_recording(path)
    assert recording.units == {"position": "m", "velocity": "m/s", "effort": "N"}
    np.testing.assert_allclose(recording.frame["position"], frame["position"] / 1000)


def test_units_are_assumed_where_none_is_declared(frames, tmp_path):
    frames("joint").to_parquet(tmp_path / "a.parquet")
    recording = read_recording(tmp_path / "a.parquet")
    assert recording.warnings == ()
    assert recording.units["position"] == "rad"


@pytest.mark.parametrize("kind", KINDS)
def test_the_kind_is_inferred(frames, tmp_path, kind):
    frames(kind).to_csv(tmp_path / "a.csv", index=False)
    assert read_recording(tmp_path / "a.csv").kind == kind


def test_the_file_decides_its_kind(frames, tmp_path):
    write_recording(recording_from_frame(frames("joint"), "joint"), tmp_path / "a.parquet")
    recording = read_recording(tmp_path / "a.parquet", "quadrotor")
    assert recording.kind == "joint"
    require_kind(recording, "joint")
    with pytest.raises(InputError, match="the platform is a quadrotor"):
        require_kind(recording, "quadrotor", "a.parquet")


def test_another_kind_than_the_platforms_is_recognised(frames, tmp_path):
    frames("quadrotor").to_csv(tmp_path / "a.csv", index=False)
    assert read_recording(tmp_path / "a.csv", "joint").kind == "quadrotor"
    frames("joint").drop(columns="position").to_csv(tmp_path / "b.csv", index=False)
    with pytest.raises(InputError, match="'position' is missing"):
        read_recording(tmp_path / "b.csv", "joint")


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_row_numbers_that_pandas_adds_are_no_column(frames, tmp_path, suffix):
    frame = frames("joint").iloc[10:]
    path = tmp_path / f"a.{suffix}"
    frame.to_csv(path) if suffix == "csv" else frame.to_parquet(path)
    assert read_recording(path).warnings == ()


def test_interleaved_runs_are_put_together(frames, tmp_path):
    frame = frames("joint")
    mixed = frame.sort_values("t", kind="stable")
    mixed.to_csv(tmp_path / "a.csv", index=False)
    pd.testing.assert_frame_equal(read_recording(tmp_path / "a.csv").frame, frame, rtol=1e-12)


def test_runs_named_by_numbers(frames, tmp_path):
    frame = frames("joint").assign(run=lambda table: table["run"].str[-1].astype(int))
    frame.to_parquet(tmp_path / "a.parquet")
    assert read_recording(tmp_path / "a.parquet").runs == ["0", "1"]


def test_the_time_step_belongs_to_cleaned_recordings(frames):
    recording = recording_from_frame(frames("joint", step=0.005), "joint")
    with pytest.raises(InputError, match="simgap clean"):
        _ = recording.time_step
    cleaned = dataclasses.replace(recording, cleaned=True)
    assert cleaned.time_step == pytest.approx(0.005)


def test_a_cleaned_recording_keeps_its_segments_and_raises_no_new_doubt(frames, tmp_path):
    frame = frames("joint", runs=1)
    frame.insert(2, "segment", np.repeat([0, 1], 100))
    units = {column: channel_units("joint")[column] for column in ("position", "velocity", "voltage")}
    write_recording(Recording(frame, "joint", units, cleaned=True), tmp_path / "a.parquet")
    recording = read_recording(tmp_path / "a.parquet")
    assert recording.cleaned
    assert recording.warnings == ()
    assert recording.frame["segment"].dtype == np.int64


def test_where_it_cannot_be_written_one_line_says_so(frames, tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        write_recording(recording_from_frame(frames("joint"), "joint"), tmp_path / "nowhere" / "a.parquet")


@pytest.mark.parametrize("kind", KINDS)
def test_required_channels_are_channels(kind):
    assert set(REQUIRED[kind]) <= set(channel_units(kind))
