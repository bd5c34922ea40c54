"""The presets under which whole tables are computed."""

import re

import pytest

from pipeline.models.registry import model_settings
from pipeline.stage.compose import compose, typed
from pipeline.stage.project import CONFIGURATION
from stages.train import TrainStage

PRESETS = sorted((CONFIGURATION / "experiment").glob("*.yaml"))


@pytest.mark.parametrize("path", PRESETS, ids=lambda path: path.stem)
def test_a_preset_opens_with_the_command_that_runs_it(path):
    first, second, *_ = path.read_text(encoding="utf-8").splitlines()
    assert first == "# @package _global_"
    assert second.startswith("# simgap ")
    assert f"+experiment={path.stem}" in second


@pytest.mark.parametrize("path", PRESETS, ids=lambda path: path.stem)
def test_the_command_of_a_preset_can_be_composed(path):
    second = path.read_text(encoding="utf-8").splitlines()[1]
    config = typed(TrainStage, compose(re.findall(r"\S+=\S+", second)))
    assert config.train.enabled
    assert model_settings(config.model).name
