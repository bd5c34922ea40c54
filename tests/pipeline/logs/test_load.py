"""From a dataset's configuration to its recording."""

from pathlib import Path

import pytest
import yaml

from simgap.errors import InputError
from simgap.logs.load import load_dataset
from simgap.recordings import write_recording
from simgap.recordings.dataset import Dataset
from simgap.recordings.recording import recording_from_frame
from simgap.recordings.split import Split, runs_of, split_runs

CONFIGURED = Path(__file__).parents[3] / "conf" / "dataset"
HELD_OUT = {
    "nanodrone": 3,
    "nanobench": 2,
    "swerve_drive": 4,
    "swerve_drive_sim": 4,
    "flywheel": 0,
    "servo_xl330": 4,
}


def _configured(name: str) -> Dataset:
    values = yaml.safe_load((CONFIGURED / f"{name}.yaml").read_text(encoding="utf-8"))
    return Dataset(**(values | {"split": Split(**values["split"])}))


@pytest.mark.parametrize("name", HELD_OUT)
def test_configured_datasets(shared_data, monkeypatch, tmp_path, name):
    monkeypatch.setenv("SIMGAP_DATA", str(shared_data))
    monkeypatch.setenv("SIMGAP_CACHE", str(tmp_path))
    dataset = _configured(name)
    recording = load_dataset(dataset)
    assert recording.licence
    assert recording.source
    parts = split_runs(recording.runs, dataset.split)
    assert len(runs_of(parts, "holdout")) == HELD_OUT[name]
    assert runs_of(parts, "train")


def test_the_default_is_a_persons_own_file(frames, tmp_path):
    dataset = _configured("default")
    with pytest.raises(InputError, match="recording=PATH"):
        load_dataset(dataset)
    write_recording(recording_from_frame(frames(), "joint"), tmp_path / "mine.parquet")
    dataset.files = [str(tmp_path / "*.parquet")]
    assert load_dataset(dataset).runs == ["run0", "run1"]


def test_a_persons_own_table(tmp_path):
    (tmp_path / "log.csv").write_text("time,pos,vel,u\n0,0,1,2\n0.1,0.1,1,3\n0.2,0.2,1,2\n")
    options = {
        "kind": "joint",
        "columns": {"t": "time", "position": "pos", "velocity": "vel", "voltage": "u"},
    }
    recording = load_dataset(Dataset(importer="table", files=[str(tmp_path / "log.csv")], options=options))
    assert recording.runs == ["log"]
    assert recording.source == "own"


@pytest.mark.parametrize(
    ("dataset", "words"),
    [
        (Dataset(source="cloud"), "dataset.source: unknown source 'cloud'"),
        (Dataset(files=["/nowhere/*.csv"]), "matches no file"),
        (Dataset(source="published", name="flywheel"), "dataset.importer: no importer is named"),
    ],
)
def test_mistakes(dataset, words):
    with pytest.raises(InputError, match=words):
        load_dataset(dataset)


def test_several_files_and_an_unknown_importer(tmp_path):
    for name in "ab":
        (tmp_path / f"{name}.csv").touch()
    with pytest.raises(InputError, match="2 files without an importer"):
        load_dataset(Dataset(files=[str(tmp_path / "*.csv")]))
    with pytest.raises(InputError, match="unknown importer 'rosbag'; use one of table"):
        load_dataset(Dataset(files=[str(tmp_path / "*.csv")], importer="rosbag"))
