"""The configuration that all stages read."""

from dataclasses import fields
from pathlib import Path

import pytest
import yaml

from simgap.artifacts.project import CONFIGURATION
from simgap.runner.command import run_command
from simgap.runner.compose import compose, root_keys, typed
from simgap.stages.configure import ConfigureStage, configure

BRANCHES = sorted(path.stem for path in (CONFIGURATION / "branch").glob("*.yaml"))


def written(*overrides: str) -> dict:
    assert run_command(configure, [*overrides, "tracking.enabled=false", "output=out"]) == 0
    return yaml.safe_load(Path("out/config.yaml").read_text())


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_it_writes_every_section() -> None:
    assert {field.name for field in fields(ConfigureStage)} == root_keys() - {"branch"}


@pytest.mark.parametrize("branch", BRANCHES)
def test_every_branch_composes_under_its_own_name(branch: str) -> None:
    config = written(f"branch={branch}")
    assert config["name"] == branch
    assert config["artifacts"] == f"artifacts/{branch}"
    assert config["dataset"]["name"]
    assert config["platform"]


def test_the_command_line_goes_before_the_branch() -> None:
    config = written("branch=nanodrone", "platform=flywheel", "name=trial", "seed=7")
    assert (config["name"], config["seed"]) == ("trial", 7)
    assert config["platform"] == compose(["platform=flywheel"])["platform"]


def test_twins_differ_in_nothing_but_what_is_concealed() -> None:
    one, other = (compose([f"branch={name}"]) for name in ("embedded", "embedded_null"))
    named = {
        "name",
        "artifacts",
        "dataset",
        "record",
        "train_policy",
        "evaluate",
    }  # the twin trains no policy
    assert {key for key in one if one[key] != other[key]} <= named
    assert one["record"] != other["record"]


def test_the_configuration_is_the_same_wherever_it_is_composed() -> None:
    assert str(Path.cwd()) not in yaml.safe_dump(compose(["branch=nanodrone"]))
    assert typed(ConfigureStage, compose([])).output is None


def test_mistakes_of_every_stage_come_to_light_at_once(capfd: pytest.CaptureFixture[str]) -> None:
    for override, line in [
        ("gap.marginn=1", "gap: unknown key 'marginn'; did you mean 'margin'?"),
        ("clean.crash=perhaps", "clean.crash: Value 'perhaps' is not a valid bool"),
    ]:
        assert run_command(configure, ["branch=embedded", "tracking.enabled=false", override]) == 2
        assert capfd.readouterr().err.startswith(f"simgap configure: {line}")
