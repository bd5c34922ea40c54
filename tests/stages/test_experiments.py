"""Presets at full scale: each opens with its command and is a valid configuration."""

import itertools
import re

import pytest

from simgap.artifacts.project import CONFIGURATION
from simgap.models.layouts import layout_of
from simgap.models.registry import model_class, model_settings
from simgap.runner.compose import compose, typed
from simgap.stages.train import TrainStage
from tests.pipeline.models import learnable

FOLDER = CONFIGURATION / "experiment"
PRESETS = sorted(path.stem for path in FOLDER.glob("*.yaml"))
SWERVE_MODELS = sorted(path.stem for path in (CONFIGURATION / "model" / "swerve").glob("*.yaml"))


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_opens_with_its_command(name):
    text = (FOLDER / f"{name}.yaml").read_text(encoding="utf-8")
    package, command, *_ = text.splitlines()
    assert package == "# @package _global_"
    assert re.match(r"# simgap \w+ -m " if "sweeper:" in text else "# simgap ", command)
    assert f"+experiment={name}" in command.split()


@pytest.mark.parametrize("path", sorted(CONFIGURATION.rglob("*.yaml")), ids=lambda path: path.stem)
def test_a_file_of_the_configuration_opens_with_what_it_is_and_the_command_that_uses_it(path):
    lines = path.read_text(encoding="utf-8").removeprefix("# @package _global_\n").splitlines()
    header = "\n".join(itertools.takewhile(lambda line: line.startswith("# "), lines))
    assert re.search(r"simgap \w+|platform=\w+", header)


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


@pytest.mark.parametrize("name", ["swerve_steering", "swerve_chassis", "swerve_sequence_length"])
def test_the_learned_swerve_drive_is_trained_on_forty_minutes_of_the_arena(name):
    config = compose([f"+experiment={name}"])
    assert config["name"] == "swerve_arena_40min"
    assert config["record"]["runs"] * config["record"]["duration"] == 40 * 60
    assert layout_of(learnable.swerve(), config["train"]["layout"]).kind == config["train"]["layout"]


@pytest.mark.parametrize("name", SWERVE_MODELS)
def test_a_model_for_swerve_drives_is_a_model(name):
    recorded = learnable.swerve()
    values = compose([f"model=swerve/{name}"])["model"]
    settings = model_settings(values)
    model = model_class(values)(layout_of(recorded, "swerve_chassis"), settings, recorded.time_step)
    assert model.settings == settings
