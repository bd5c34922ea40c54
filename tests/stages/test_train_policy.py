"""Training and evaluating a policy, as a person does it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from simgap.effects import effect_by_key
from simgap.errors import InputError
from simgap.policies.export import ONNX_FILE, SCRIPT_FILE
from simgap.policies.settings import PolicyEvaluation, PolicyTraining
from simgap.policies.storage import load_policy
from simgap.runner import StageRun
from simgap.runner.command import main
from simgap.simulation import FittedEffect, Simulator, write_simulator
from simgap.stages.deploy import deploy
from simgap.stages.evaluate import EvaluateStage, evaluate
from simgap.stages.train_policy import TrainPolicyStage, train_policy
from tests.pipeline.policies.racing.machines import racer
from tests.stages.racing import FEW, RACE, ran

ROOT = Path(__file__).parents[2]


def test_a_policy_carries_what_it_was_trained_with(trained):
    folder = trained / "train_policy" / "policy"
    _, description = load_policy(folder)
    assert description.task == "racing"
    assert description.observation_size == 31
    assert description.configuration["track"]["name"] == "tiny"
    assert description.configuration["platform"]["mass"] == 0.87
    assert description.simulator == ""
    assert (folder / ONNX_FILE).stat().st_size > 0
    assert (folder / SCRIPT_FILE).stat().st_size > 0
    curve = json.loads((trained / "train_policy" / "curve.json").read_text())
    assert [entry["interactions"] for entry in curve] == [512.0 * (n + 1) for n in range(24)]
    assert not (trained / "checkpoints").exists()


def test_an_evaluation_writes_laps_a_flight_and_its_picture(trained):
    ran(
        evaluate,
        f"artifacts={trained}",
        "evaluate.starts=5",
        "evaluate.seconds=2.0",
        "tracking.enabled=false",
    )
    folder = trained / "evaluate"
    assert {"completed", "laps_completed"} <= json.loads((folder / "metrics.json").read_text()).keys()
    laps = pd.read_parquet(folder / "laps.parquet")
    assert laps.groupby("machine")["lap"].apply(list).tolist() == [[1, 2]] * 5
    flight = pd.read_parquet(folder / "flight.parquet")
    assert np.allclose(np.diff(flight["t"]), 0.02)
    assert np.allclose(
        np.linalg.norm(flight[[f"attitude_{axis}" for axis in "wxyz"]], axis=1), 1.0, atol=1e-4
    )
    assert (folder / "line.png").read_bytes().startswith(b"\x89PNG")


def test_a_simulator_of_another_stage_changes_the_flight(trained, tmp_path):
    effect = effect_by_key("quadrotor", "rotor_drag")
    strong = {**effect.defaults(), **{name: 5.0 * value for name, value in effect.defaults().items()}}
    write_simulator(Simulator(racer(), (FittedEffect(effect, strong),)), tmp_path / "simulator")
    few = ("evaluate.starts=5", "evaluate.seconds=1.0", "tracking.enabled=false", f"artifacts={trained}")
    ran(evaluate, *few, f"output={tmp_path / 'ideal'}")
    ran(evaluate, *few, f"output={tmp_path / 'other'}", f"evaluate.simulator={tmp_path / 'simulator'}")
    ideal, other = (pd.read_parquet(tmp_path / name / "flight.parquet") for name in ("ideal", "other"))
    common = min(len(ideal), len(other))
    assert not np.allclose(ideal["velocity_x"][:common], other["velocity_x"][:common])


def test_a_killed_training_of_a_policy_ends_like_an_undisturbed_one(trained, tmp_path):
    command = [sys.executable, "-m", "simgap.stages.train_policy", *FEW, f"artifacts={tmp_path}"]
    process = subprocess.Popen(command, cwd=ROOT, env={**os.environ, "OMP_NUM_THREADS": "1"})
    while process.poll() is None and not any(tmp_path.rglob("checkpoint.pt")):
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "train_policy").exists()
    assert any(tmp_path.rglob("checkpoint.pt"))
    ran(train_policy, *FEW, f"artifacts={tmp_path}")
    for file in ("curve.json", "metrics.json", "policy/policy.yaml", "policy/policy.safetensors"):
        assert (tmp_path / "train_policy" / file).read_bytes() == (
            trained / "train_policy" / file
        ).read_bytes()


@pytest.mark.slow(minutes=2)
def test_the_tiny_track_is_learnt(tmp_path):
    enough = (*RACE, "train_policy.learning.interactions=1_000_000")
    for stage, settings in (("train_policy", enough), ("evaluate", ("tracking.enabled=false",))):
        command = [sys.executable, "-W", "ignore", "-m", "stages", stage, *settings, f"artifacts={tmp_path}"]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    metrics = json.loads((tmp_path / "evaluate" / "metrics.json").read_text())
    assert metrics["completed"] > 0.95
    assert metrics["laps_completed"] > 0.9
    assert metrics["least_margin"] >= 0.15


def test_without_a_task_a_person_is_told_what_to_give_and_nothing_is_left(tmp_path):
    command = [sys.executable, "-m", "simgap.stages.train_policy"]
    environment = {key: value for key, value in os.environ.items() if key != "DVC_STAGE"}
    for places in (["platform=racer"], ["platform=racer", "output=there"], []):
        done = subprocess.run(
            [*command, *places, f"tracking.uri=sqlite:///{tmp_path}/runs.db"],
            cwd=tmp_path,
            env=environment | {"PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 2
        assert done.stderr.splitlines() == [
            "simgap train_policy: train_policy.task: no task is set, so there is nothing to train; "
            f"give {'' if places else 'platform=racer '}train_policy=racing_quick"
        ]
        assert list(tmp_path.iterdir()) == []


def test_a_branch_without_a_policy_trains_none_and_flies_none(tmp_path, monkeypatch):
    monkeypatch.setenv("DVC_STAGE", "train_policy@nanodrone")  # as DVC does
    for stage in (train_policy, evaluate):
        ran(stage, f"artifacts={tmp_path}", "tracking.enabled=false")
        assert [path.name for path in (tmp_path / stage.name).iterdir()] == ["metrics.json"]
        assert json.loads((tmp_path / stage.name / "metrics.json").read_text()) == {}


def test_mistakes_are_said_in_one_line(tmp_path):
    run = StageRun(tmp_path)
    with pytest.raises(InputError, match="no task 'swim'"):
        train_policy(TrainPolicyStage(train_policy=PolicyTraining(task="swim")), run)
    with pytest.raises(InputError, match="does not exist"):
        evaluate(EvaluateStage(evaluate=PolicyEvaluation(policy=str(tmp_path / "none"))), run)
    arm = {"kind": "joint", "inertia": 0.1}
    with pytest.raises(InputError, match="joint cannot race"):
        train_policy(TrainPolicyStage(platform=arm, train_policy=PolicyTraining(task="racing")), run)


@pytest.mark.parametrize("name", sorted(path.stem for path in (ROOT / "conf" / "track").glob("*.yaml")))
def test_every_track_is_a_valid_configuration(name):
    from simgap.gates.track import track_from
    from simgap.runner.compose import compose, typed

    config = typed(TrainPolicyStage, compose([f"track={name}", "train_policy=racing"]))
    assert config.track.name == name
    assert len(track_from(config.track)) == len(
        yaml.safe_load((ROOT / "conf/track" / f"{name}.yaml").read_text())["gates"]
    )


@pytest.mark.parametrize(
    ("stage", "override"),
    [
        (train_policy, "train_policy.learning.interactions=0"),
        (train_policy, "train_policy.learning.machines=0"),
        (train_policy, "train_policy.learning.learning_rate=-1"),
        (train_policy, "train_policy.learning.discount=-0.5"),
        (evaluate, "evaluate.starts=0"),
        (evaluate, "evaluate.laps=-1"),
        (evaluate, "evaluate.seconds=0"),
        (deploy, "deploy.most_flights=0"),
    ],
)
def test_a_number_that_leaves_nothing_to_do_is_refused_and_nothing_is_lost(trained, stage, override, capsys):
    policy = (trained / "train_policy" / "policy" / "policy.safetensors").read_bytes()
    with pytest.raises(SystemExit) as ended:
        main(stage, [*FEW, f"artifacts={trained}", override])
    assert ended.value.code == 2
    key = override.partition("=")[0]
    assert f"{key}: must" in capsys.readouterr().err
    assert (trained / "train_policy" / "policy" / "policy.safetensors").read_bytes() == policy


@pytest.mark.parametrize("stage", [evaluate, deploy])
def test_a_policy_flies_only_the_machine_that_it_was_trained_for(trained, stage, capsys):
    with pytest.raises(SystemExit) as ended:
        main(stage, ["platform=crazyflie_brushless", f"artifacts={trained}", "tracking.enabled=false"])
    assert ended.value.code == 2
    assert "trained for another platform" in capsys.readouterr().err


def test_an_evaluation_says_how_the_race_went(trained, capsys):
    ran(evaluate, *FEW, f"artifacts={trained}", "evaluate.starts=2", "evaluate.seconds=0.5")
    assert "0% of laps on tiny" in capsys.readouterr().out
