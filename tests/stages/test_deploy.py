"""Races on the concealed machine whose estimate is corrected by what a detector finds in its images."""

import json
from dataclasses import replace

import pytest
import torch

from simgap.perception.detector import Detector
from simgap.perception.storage import save_detector
from simgap.runner.command import main
from simgap.stages.deploy import deploy
from simgap.stages.train_detector import train_detector
from tests.pipeline.perception.eyes import perception
from tests.stages.racing import ran

SMALL = ("perception.camera.image=[64,64]", "perception.images.exposures=1")
SHORT = (
    "platform=racer",
    "record=racing_plain",
    "evaluate.starts=2",
    "evaluate.seconds=0.2",
    "tracking.enabled=false",
)
LEARNED = [f"perception.detector.learning.{key}=1" for key in ("batch", "steps", "epochs", "validation")]


def metrics(folder):
    return json.loads((folder / "metrics.json").read_text())


def refused(*overrides):
    with pytest.raises(SystemExit) as ended:
        main(deploy, [*overrides])
    return ended.value.code


def test_a_branch_that_asks_for_no_detector_trains_none(tmp_path, monkeypatch):
    monkeypatch.setenv("DVC_STAGE", "train_detector@embedded")  # as DVC does
    ran(train_detector, f"artifacts={tmp_path}", "tracking.enabled=false")
    assert [path.name for path in (tmp_path / "train_detector").iterdir()] == ["metrics.json"]


@pytest.mark.slow
def test_a_branch_that_asks_for_a_detector_flies_with_it(trained, tmp_path, monkeypatch):
    monkeypatch.setenv("DVC_STAGE", "train_detector@embedded")
    places = (f"artifacts={tmp_path}", f"evaluate.policy={trained / 'train_policy' / 'policy'}")
    asked = (*places, *SMALL, "perception.detector.enabled=true")
    ran(train_detector, *asked, *LEARNED, "tracking.enabled=false")
    ran(deploy, *asked, *SHORT)
    ran(deploy, *places, *SHORT, "deploy=odometry", f"output={tmp_path / 'without'}")
    seen, without = metrics(tmp_path / "deploy"), metrics(tmp_path / "without")
    assert seen["images"] == 2 * 5  # of two machines in a fifth of a second
    assert {"gates_found", "gates_believed", "gate_in_view", "position_error"} <= set(seen)
    assert not {"images", "gate_in_view"} & set(without)


def test_a_detector_gives_the_same_race_again(trained, tmp_path):
    torch.manual_seed(0)
    small = replace(perception(), camera=replace(perception().camera, image=[64, 64]))
    save_detector(Detector(small.detector), small, {}, tmp_path / "eye")
    policy = f"evaluate.policy={trained / 'train_policy' / 'policy'}"
    races = []
    for name in ("one", "two"):
        output = f"output={tmp_path / name}"
        ran(deploy, policy, f"deploy.detector={tmp_path / 'eye'}", *SMALL, *SHORT, output)
        races.append((tmp_path / name / "flight.parquet").read_bytes())
    assert races[0] == races[1]


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["deploy.detector={folder}"], "detector.yaml: cannot be read"),
        (["deploy.detector={folder}/none"], "none: does not exist"),
        (
            ["deploy.detector={folder}", "deploy.gates=false"],
            "deploy.detector: is given, but deploy.gates is",
        ),
        (["deploy.detector={folder}/eye", "record.estimates=0"], "record.estimates: leaves no error"),
        (["deploy.detector={folder}/eye", *SMALL], "eye: was trained with another camera"),
        (
            ["deploy.detector={folder}/eye", "evaluate.pilot=time_optimal", "track.gates=[]"],
            "has fewer than two gates",
        ),
    ],
)
def test_what_cannot_be_flown_with_is_said_in_one_line(trained, tmp_path, capsys, overrides, message):
    save_detector(Detector(perception().detector), perception(), {}, tmp_path / "eye")
    given = [each.format(folder=tmp_path) for each in overrides]
    assert refused(*SHORT, f"artifacts={trained}", *given, f"output={tmp_path / 'out'}") == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert message in line
    assert not (tmp_path / "out").exists()
