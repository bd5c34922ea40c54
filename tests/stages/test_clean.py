import json

import numpy as np
import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.recordings import read_recording, write_recording
from simgap.recordings.split import Split
from simgap.runner import StageRun
from simgap.runner.command import main
from simgap.stages.clean import CleanStage, clean
from tests.pipeline.recordings.cleaning.conftest import joint_frame, recording_of


@pytest.fixture
def recorded(tmp_path):
    frame = pd.concat(
        [joint_frame(run=name, seed=seed) for seed, name in enumerate("abcd")], ignore_index=True
    )
    frame.loc[100:103, "velocity"] = np.nan
    frame = frame.drop(index=range(700, 750)).reset_index(drop=True)
    path = tmp_path / "raw.parquet"
    write_recording(recording_of(frame, "joint"), path)
    return path


def test_the_stage_writes_the_recording_and_the_whole_account(recorded, tmp_path, capsys):
    output = tmp_path / "clean"
    output.mkdir()
    run = StageRun(output)
    config = CleanStage(recording=str(recorded))
    config.dataset.split = Split(holdout=["d"])
    clean(config, run)
    result = read_recording(output / "recording.parquet")
    assert result.cleaned
    assert result.split["d"] == "holdout"
    changes = pd.read_parquet(output / "changes.parquet")
    assert changes.query("step == 'fill'")["samples"].tolist() == [4]
    assert set(pd.read_parquet(output / "coverage.parquet")["state"]) == {"kept", "interpolated", "missing"}
    assert (output / "coverage.svg").read_text().startswith("<svg")
    assert run.metrics["samples"] == len(result.frame) == 2350
    assert run.metrics["samples_interpolated"] == 4
    printed = capsys.readouterr().out
    assert all(name in printed for name in ("recorded", "dropped", "holdout"))


def test_the_command_writes_the_same_bytes_twice(recorded, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    contents = []
    for name in ("first", "second"):
        with pytest.raises(SystemExit) as ended:
            main(clean, [f"recording={recorded}", f"output={tmp_path / name}", "tracking.enabled=false"])
        assert ended.value.code in (0, None)
        contents.append({path.name: path.read_bytes() for path in sorted((tmp_path / name).iterdir())})
    assert contents[0] == contents[1]
    assert json.loads(contents[0]["metrics.json"])["runs"] == 4


def test_a_recording_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nowhere\.parquet"):
        clean(CleanStage(recording=str(tmp_path / "nowhere.parquet")), StageRun(tmp_path))
