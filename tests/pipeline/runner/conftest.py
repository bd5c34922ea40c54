"""A tiny stage in a module of its own, as `stages/NAME.py` would be, with a configuration of its own."""

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
import yaml

from simgap.artifacts.project import CONFIGURATION
from simgap.runner import compose

SOURCE = '''
import random
from dataclasses import dataclass, field
from typing import Any

from simgap.errors import InputError
from simgap.runner import StageConfig, StageRun, stage


@dataclass
class Drawing:
    amount: int = 2
    scale: float = 1.0


@dataclass
class TinyStage(StageConfig):
    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    drawing: Drawing = field(default_factory=Drawing)


@stage(TinyStage)
def tiny_stage(config: TinyStage, run: StageRun) -> None:
    """Draw some numbers.

    And write them down.
    """
    if config.recording:
        run.input(config.recording)
    if config.drawing.amount < 0:
        raise InputError("must not be negative", "drawing.amount", "give another one")
    draws = [config.drawing.scale * random.random() for _ in range(config.drawing.amount)]
    (run.output / "draws").write_text(repr(draws))
    run.log_metrics({"sum": sum(draws), "undefined": float("nan")})
    if config.drawing.amount == 13:
        raise RuntimeError("a bug")


if __name__ == "__main__":
    from simgap.runner.command import main

    main(tiny_stage)
'''

ROOT = """
defaults:
  - platform: null
  - drawing: default
  - clean: null
  - tracking: default
  - results: default
  - _self_
  - override hydra/job_logging: plain
  - override hydra/hydra_logging: plain
name: default
artifacts: artifacts/${name}
seed: 0
recording: null
output: null
gap: {effects: null}
"""
GROUPS = {
    "drawing/default": "amount: 2",  # `scale` has its default in the dataclass
    "platform/sparrow": "mass: 0.03",
    "platform/eagle": "mass: 4.0",
    "clean/gently": "crash: true",
    "experiment/pair": """# @package _global_
drawing: {scale: 2.0}
results: {title: A pair, tables: [{metrics: sum}]}
hydra: {sweeper: {params: {seed: "1,2", drawing.amount: "1,3"}}}
""",
}


@pytest.fixture
def configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of a small configuration, which takes the place of the project's."""
    folder = tmp_path / "conf"
    for group in ("hydra", "tracking", "results"):
        shutil.copytree(CONFIGURATION / group, folder / group)
    for name, text in GROUPS.items():
        path = folder / f"{name}.yaml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    root = yaml.safe_load((CONFIGURATION / "config.yaml").read_text())
    (folder / "config.yaml").write_text(ROOT + yaml.safe_dump({"hydra": root["hydra"]}))
    monkeypatch.setattr(compose, "CONFIGURATION", folder)
    return folder


@pytest.fixture
def tiny(tmp_path: Path, configuration: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """Return the module of the stage; the working directory is an empty folder `work`."""
    folder = tmp_path / "modules"
    folder.mkdir()
    (folder / "tiny_stage.py").write_text(SOURCE)
    work = tmp_path / "work"
    work.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))  # for the workers of a sweep
    monkeypatch.chdir(work)
    import tiny_stage

    yield tiny_stage
    del sys.modules["tiny_stage"]
