"""The branch of the swerve shuttle at a small scale, by the commands that DVC runs."""

import importlib
import json
from pathlib import Path

import pytest

from simgap.models.storage import load_model
from simgap.models.tcn import TemporalConvolutionModel
from simgap.policies.profile.storage import FILE, read_motions
from tests.stages.racing import ran

SMALL = (
    "branch=swerve_shuttle",
    "tracking.enabled=false",
    "record.runs=8",
    "record.duration=4",
    "model.hidden=[8]",
    "model.dropout=[]",
    "train.max_epochs=2",
    "train.horizons=[1,10]",
    "gap.effects=[coulomb_friction,wheel_radius_error]",
    "profile.learning.interactions=2000",
    "profile.learning.machines=16",
    "profile.learning.hidden=[8]",
    "profile.episode=1.0",
    "deploy.trials=1",
)
STAGES = ("record", "clean", "sysid", "train", "build_sim", "diagnose", "profile", "deploy", "report")
POLICIES = {"policy", "policy_in_build_sim", "policy_in_diagnose"}


@pytest.mark.slow
def test_from_the_recording_to_trials_of_policies_of_three_simulators(tmp_path: Path) -> None:
    for name in STAGES:
        stage = getattr(importlib.import_module(f"simgap.stages.{name}"), name)
        ran(stage, *SMALL, f"artifacts={tmp_path}")
    model = load_model(tmp_path / "train" / "model")
    assert isinstance(model, TemporalConvolutionModel)
    assert (tmp_path / "build_sim" / "learned" / "model.safetensors").read_bytes() == (
        tmp_path / "train" / "model" / "model.safetensors"
    ).read_bytes()
    motions = read_motions(tmp_path / "profile" / FILE)
    assert set(motions) > POLICIES
    assert motions["policy"].period == pytest.approx(model.time_step)
    driven = json.loads((tmp_path / "deploy" / "metrics.json").read_text())
    for name in ("", *(f"{other}/" for other in POLICIES - {"policy"})):
        assert driven[f"{name}trials/number"] == 1
        assert driven[f"{name}trials/worst_miss"] > 0.0
    page = (tmp_path / "report" / "report.html").read_text()
    assert "policy in build sim" in page
    pictures = 1 + 1 + 4  # residuals of the model, all plans, and the trials of four motions
    assert page.count("data:image/svg+xml;base64,") == pictures
