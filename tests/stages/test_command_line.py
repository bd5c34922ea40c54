"""`simgap` as a person types it."""

import importlib
import os
import subprocess
import sys
import tomllib
from dataclasses import fields
from pathlib import Path

import pytest

from simgap.artifacts import PROJECT_ROOT
from simgap.artifacts.project import STAGES
from simgap.runner.project import commands, described, file_of
from simgap.stages.__main__ import ORDER, main

NO_STAGES = {"import", "inspect", "reproduce", "results", "effects", "motors", "stages"}


def simgap(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    program = str(Path(sys.executable).parent / "simgap")
    return subprocess.run(
        [program, *arguments], cwd=folder, capture_output=True, text=True, check=False, env=os.environ
    )


def test_help_lists_every_stage_with_what_it_does(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["--help"])
    assert caught.value.code == 0
    text = capsys.readouterr().out
    for name, summary in commands().items():
        assert f"  {name} " in text
        assert summary in text
        assert summary.endswith(".")


def test_the_version_is_that_of_the_project(capsys: pytest.CaptureFixture[str]) -> None:
    stated = tomllib.loads((PROJECT_ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "version"
    ]
    with pytest.raises(SystemExit) as caught:
        main(["--version"])
    assert (caught.value.code, capsys.readouterr().out) == (0, f"simgap {stated}\n")


def test_help_names_the_stages_in_their_order() -> None:
    assert set(commands()) <= set(ORDER)
    assert {path.stem for path in STAGES.glob("[a-z]*.py")} == {*map(file_of, commands())}


@pytest.mark.parametrize(
    "arguments", [["--help"], ["diagnose", "--help"], ["train", "-m", "-h"], ["effects", "-h"]]
)
def test_help_loads_nothing_heavy(arguments: list[str]) -> None:
    code = (
        f"import sys\nfrom simgap.stages.__main__ import main\ntry:\n    main({arguments})\n"
        "except SystemExit as end:\n    assert not end.code\n"
        "heavy = {'numpy', 'pandas', 'torch', 'mlflow', 'hydra', 'omegaconf'} & set(sys.modules)\n"
        "sys.exit(bool(heavy))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize("name", sorted(set(commands()) - NO_STAGES))
def test_help_of_a_stage_is_read_from_its_file(name: str) -> None:
    stage = getattr(importlib.import_module(f"simgap.stages.{name}"), name)
    assert described(name) == (stage.__doc__, [field.name for field in fields(stage.config_class)])


@pytest.mark.parametrize("name", sorted(NO_STAGES))
def test_what_is_no_stage_explains_itself(name: str) -> None:
    assert described(name) is None


def test_an_unknown_command_is_answered_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["configur"])
    assert caught.value.code == 2
    assert capsys.readouterr().err == "simgap: unknown command 'configur'; did you mean 'configure'?\n"


def test_it_works_from_any_folder(tmp_path: Path) -> None:
    done = simgap("configure", "branch=flywheel", "tracking.enabled=false", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "configure: wrote artifacts/flywheel/configure\n"
    assert (tmp_path / "artifacts/flywheel/configure/config.yaml").is_file()


def test_a_mistake_ends_with_exit_code_2_and_one_line(tmp_path: Path) -> None:
    done = simgap("configure", "branch=flywheels", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "simgap configure: branch: there is no 'flywheels'; did you mean 'flywheel'?\n"
    assert list(tmp_path.iterdir()) == []


def test_a_reader_that_has_seen_enough_is_no_error(tmp_path: Path) -> None:
    simgap("configure", "branch=flywheel", "tracking.enabled=false", folder=tmp_path)
    rows = "\n".join(f"{row / 100},{row % 7},{row % 5}" for row in range(300))
    (tmp_path / "log.csv").write_text(f"a,b,c\n{rows}\n")
    for command in ("inspect log.csv --kind joint", "configure branch=flywheel tracking.enabled=false"):
        done = subprocess.run(
            f"{sys.executable} -m simgap {command} | true",
            shell=True, cwd=tmp_path, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.stderr == ""


@pytest.mark.parametrize(
    ("module", "said"), [("simgap", "usage: simgap COMMAND"), ("simgap.stages.clean", "usage: simgap clean")]
)
def test_the_package_and_each_stage_run_as_modules(module: str, said: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", module, "--help"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert said in done.stdout


def test_a_mistake_is_one_line_when_a_stage_runs_as_a_module(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "simgap.stages.clean", "recording=missing.parquet", "output=out"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("simgap clean: ")
    assert done.stderr.count("\n") == 1
