"""Presets at full scale: each opens with its command and is a valid configuration."""

from pathlib import Path

import pytest

from pipeline.models.registry import model_settings
from pipeline.stage.compose import compose, typed
from stages.train import TrainStage

FOLDER = Path(__file__).parents[2] / "conf" / "experiment"
PRESETS = sorted(path.stem for path in FOLDER.glob("*.yaml"))


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_opens_with_its_command(name):
    package, command, *_ = (FOLDER / f"{name}.yaml").read_text(encoding="utf-8").splitlines()
    assert package == "# @package _global_"
    assert command.startswith("# simgap ")
    assert f"+experiment={name}" in command


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_is_a_valid_configuration(name):
    command = (FOLDER / f"{name}.yaml").read_text(encoding="utf-8").splitlines()[1]
    overrides = dict.fromkeys(word for word in command.split() if "=" in word)
    config = typed(TrainStage, compose([*overrides]))
    assert model_settings(config.model).sequence_length >= 1


@pytest.mark.parametrize("model", ["white_box", "black_box", "hybrid_parallel", "hybrid_serial"])
def test_the_hybrids_are_compared_by_choice_of_the_model(model):
    config = typed(TrainStage, compose(["+experiment=nanodrone_hybrid", f"model={model}"]))
    assert model_settings(config.model).name == model


def test_the_benchmark_filters_as_published():
    config = typed(TrainStage, compose(["+experiment=nanodrone_benchmark"]))
    assert config.train.zero_phase == {
        "position": 10,
        "attitude": 12,
        "velocity": 18,
        "body_rate": 18,
        "motor_speed": 20,
    }
    live = typed(TrainStage, compose(["+experiment=nanodrone_benchmark", "train.zero_phase=null"]))
    assert live.train.zero_phase is None
