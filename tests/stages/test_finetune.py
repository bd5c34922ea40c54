"""Flying a policy in reality, finding what that shows and training further, as a person does it."""

import json
import shutil
from pathlib import Path

import pandas as pd
import pytest
import yaml

from simgap.errors import InputError
from simgap.policies.settings import PolicyFinetuning
from simgap.policies.storage import load_policy
from simgap.recordings.recording import read_recording
from simgap.runner import StageRun
from simgap.simulation import read_simulator
from simgap.stages.deploy import deploy
from simgap.stages.finetune import FinetuneStage, finetune
from simgap.stages.identify_residual import identify_residual
from simgap.stages.redeploy import redeploy
from tests.stages.racing import FEW, ran

FLOWN = (
    "evaluate.starts=4",
    "evaluate.seconds=2.0",
    "record.estimates=1.0",
    "record.effects={rotor_drag: 0.5}",
)


@pytest.fixture(scope="module")
def artifacts(trained, tmp_path_factory) -> Path:
    """Return what the whole loop wrote, all of it far too short."""
    artifacts = tmp_path_factory.mktemp("loop")
    shutil.copytree(trained / "train_policy", artifacts / "train_policy")
    common = (*FEW, *FLOWN, f"artifacts={artifacts}")
    ran(deploy, *common)
    ran(
        identify_residual,
        *common,
        "residual.simulator=ideal",
        "residual.observation.samples=100",
        "residual.observation.iterations=5",
    )
    ran(finetune, *common, "finetune.enabled=true", "finetune.interactions=2_000")
    ran(redeploy, *common)
    return artifacts


def test_races_are_recorded_with_what_the_machine_believed(artifacts):
    recording = read_recording(artifacts / "deploy" / "recording.parquet")
    assert recording.kind == "quadrotor"
    assert len(recording.runs) >= 3
    frame = recording.frame
    assert {"estimate_position_x", "thrust_command", "body_rate_command_z", "motor_command_1"} <= set(frame)
    wrong = frame["estimate_velocity_x"] - frame["velocity_x"]
    assert 0.0 < wrong.abs().mean() < 1.0


def test_residuals_become_a_simulator_and_draws_with_a_picture(artifacts):
    folder = artifacts / "identify_residual"
    simulator = read_simulator(folder / "simulator")
    assert [fitted.effect.name for fitted in simulator.effects] == ["recorded_residual"]
    described = yaml.safe_load((folder / "observation" / "observation.yaml").read_text())
    assert described["draws"] == 100
    assert (folder / "realisations.png").read_bytes().startswith(b"\x89PNG")
    metrics = json.loads((folder / "metrics.json").read_text())
    assert {"residual_force_x", "misjudged_position_x", "misjudged_tilt_z"} <= metrics.keys()


def test_training_goes_on_from_the_policy_in_the_simulator_with_residuals(artifacts):
    before, _ = load_policy(artifacts / "train_policy" / "policy")
    after, description = load_policy(artifacts / "finetune" / "policy")
    assert description.simulator != ""
    assert description.configuration["learning"]["interactions"] == 2_000
    moved = [
        float((one - other).norm() / other.norm())
        for one, other in zip(after.parameters(), before.parameters(), strict=True)
        if float(other.norm()) > 0
    ]
    assert 0.0 < max(moved) < 0.5  # a new policy would have nothing in common with it
    assert pd.read_parquet(artifacts / "redeploy" / "laps.parquet")["machine"].nunique() == 4


def test_a_policy_may_stay_in_its_simulator_and_learn_the_errors_of_the_estimate_alone(artifacts, tmp_path):
    few = ("finetune.enabled=true", "finetune.interactions=2_000", "finetune.simulator=ideal")
    ran(finetune, *FEW, *FLOWN, *few, f"artifacts={artifacts}", f"output={tmp_path / 'ideal'}")
    with_residuals, in_its_own = (
        load_policy(folder / "policy")[1].simulator for folder in (artifacts / "finetune", tmp_path / "ideal")
    )
    assert with_residuals
    assert in_its_own == load_policy(artifacts / "train_policy" / "policy")[1].simulator


def test_where_nothing_was_trained_nothing_is_flown_or_trained_further(tmp_path):
    for stage in (deploy, identify_residual, finetune, redeploy):
        ran(stage, f"artifacts={tmp_path}", "platform=racer", "tracking.enabled=false")
        assert [path.name for path in (tmp_path / stage.name).iterdir()] == ["metrics.json"]
        assert json.loads((tmp_path / stage.name / "metrics.json").read_text()) == {}


def test_a_policy_that_is_not_there_is_said_in_one_line(tmp_path):
    chosen = PolicyFinetuning(enabled=True, policy=str(tmp_path / "none"))
    with pytest.raises(InputError, match="does not exist"):
        finetune(FinetuneStage(finetune=chosen), StageRun(tmp_path))
