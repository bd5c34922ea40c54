"""The presets of the learned swerve drive are whole commands."""

import pytest

from pipeline.models.layout import layout_of
from pipeline.models.registry import model_class, model_settings
from pipeline.stage.compose import compose
from pipeline.stage.project import CONFIGURATION
from tests.pipeline.models import learnable

SWEEPS = ("swerve_steering", "swerve_chassis", "swerve_sequence_length")
MODELS = sorted(path.stem for path in (CONFIGURATION / "model" / "swerve").glob("*.yaml"))


@pytest.mark.parametrize("name", SWEEPS)
def test_a_preset_opens_with_its_command_and_trains_on_the_arena(name):
    lines = (CONFIGURATION / "experiment" / f"{name}.yaml").read_text().splitlines()
    assert lines[1] == f"# simgap train -m +experiment={name}"
    config = compose([f"+experiment={name}"])
    assert config["name"] == "swerve_arena_40min"
    assert config["record"]["runs"] * config["record"]["duration"] == 40 * 60
    assert layout_of(learnable.swerve(), config["train"]["layout"]).kind == config["train"]["layout"]


@pytest.mark.parametrize("name", MODELS)
def test_a_model_for_swerve_drives_is_a_model(name):
    recorded = learnable.swerve()
    values = compose([f"model=swerve/{name}"])["model"]
    settings = model_settings(values)
    model = model_class(values)(layout_of(recorded, "swerve_chassis"), settings, recorded.time_step)
    assert model.settings == settings
