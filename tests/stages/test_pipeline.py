"""dvc.yaml says of every stage what its code says."""

import importlib
import json
import os
import subprocess
import sys
from dataclasses import fields
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
import yaml

from simgap.artifacts import PROJECT_ROOT
from simgap.artifacts.project import CONFIGURATION
from simgap.runner.project import commands
from tools.link_package import link_package

# Keys that say where a stage works, what it is called and how its sweeps are compared, not what it does.
PLACES = {"name", "artifacts", "output", "tracking", "results"}
# Parts of the project that cannot change what a stage writes; a branch names its platform, and reads no robot's file.
SILENT = {
    f"simgap.{name}"
    for name in ("checks", "comparison", "compiled", "errors", "extras", "lazy", "robot_files", "tracking")
}

PIPELINE = yaml.safe_load((PROJECT_ROOT / "dvc.yaml").read_text())
STAGES: dict[str, Any] = {name: entry["do"] for name, entry in PIPELINE["stages"].items()}
BRANCHES = next(entry["branches"] for entry in PIPELINE["vars"] if "branches" in entry)


GRAPH = """
import json, grimp
graph = grimp.build_graph("simgap", cache_dir=None)
stages = [module for module in graph.modules if module.startswith("simgap.stages.")]
print(json.dumps({stage: sorted(graph.find_upstream_modules(stage)) for stage in stages}))
"""


@cache
def upstream_modules() -> dict[str, list[str]]:
    """Return what every module of `stages/` imports, however indirectly; read from files laid out as one package."""
    with TemporaryDirectory() as folder:
        link_package(Path(folder))
        environment = os.environ | {"PYTHONPATH": folder}
        done = subprocess.run([sys.executable, "-c", GRAPH], env=environment, capture_output=True, check=True)
    return json.loads(done.stdout)


def test_every_stage_is_in_it_for_every_branch() -> None:
    beside = {
        "inspect",
        "import",
        "reproduce",
        "prove",
        "calibrate",
        "results",
        "effects",
        "motors",
        "stages",
    }
    assert set(STAGES) == set(commands()) - beside
    assert {entry["foreach"] for entry in PIPELINE["stages"].values()} == {"${branches}"}
    assert sorted(BRANCHES) == sorted(path.stem for path in (CONFIGURATION / "branch").glob("*.yaml"))


def test_no_branch_is_called_broken_before_it_ran() -> None:
    """`dvc metrics show` complains of every file that it is told of and that is not there yet."""
    assert "metrics" not in PIPELINE


def upstream(name: str) -> set[str]:
    """Return the stages but record that a stage waits for."""
    before = {entry.rpartition("/")[2] for entry in STAGES[name]["deps"] if entry.startswith("artifacts/")}
    return (before - {"record"}).union(*(upstream(other) for other in before))


@pytest.mark.parametrize("name", STAGES)
def test_a_stage_runs_its_command_and_owns_its_folder(name: str) -> None:
    assert STAGES[name]["cmd"] == f"simgap {name} branch=${{item}}"
    (out,) = STAGES[name]["outs"]
    folder = f"artifacts/${{item}}/{name}"
    # The configuration has to be there, not only in the cache, for DVC to read values from it.
    assert out == ({folder: {"cache": False}} if name == "configure" else folder)


@pytest.mark.parametrize("name", [name for name in STAGES if name != "configure"])
def test_a_stage_depends_on_the_values_that_it_reads(name: str) -> None:
    stage = getattr(importlib.import_module(f"simgap.stages.{name}"), name)
    ((file, keys),) = STAGES[name]["params"][0].items()
    assert file == "artifacts/${item}/configure/config.yaml"
    assert set(keys) == {field.name for field in fields(stage.config_class)} - PLACES


@pytest.mark.parametrize("name", STAGES)
def test_a_stage_depends_on_the_code_that_it_imports(name: str) -> None:
    modules = upstream_modules()[f"simgap.stages.{name}"]
    packages = {".".join(module.split(".")[:2]) for module in modules} - {"simgap", "simgap.stages"}
    code = {entry for entry in STAGES[name]["deps"] if not entry.startswith(("artifacts/", "conf"))}
    helpers = {module for module in modules if module.startswith("simgap.stages.")}
    own = {f"stages/{module.rpartition('.')[2]}.py" for module in helpers | {f"simgap.stages.{name}"}}
    assert code == {package.replace("simgap.", "pipeline/") for package in packages - SILENT} | own


def test_no_path_leads_from_the_concealed_plants_to_a_diagnosis() -> None:
    """Beside the recording, record writes an answer key: no stage but clean reads its folder, and those that have to do
    with the plants stand behind the diagnosis."""
    readers = {name for name, stage in STAGES.items() if "artifacts/${item}/record" in str(stage["deps"])}
    assert readers == {"clean"}
    uses = {name for name, stage in STAGES.items() if "pipeline/plants" in stage["deps"]}
    assert uses == {"record", "deploy", "redeploy"}
    assert not uses & upstream("diagnose")
