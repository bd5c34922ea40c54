"""The package as a stranger installs it: a wheel, its core dependencies, and a folder with things of their own in it.

The interpreter that runs the tests is tried always; SIMGAP_PYTHONS names others, separated by colons.
"""

import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.contract_checker import read_diagnosis
from tests.pipeline.gap.recordings import Plant, joint_recording

ROOT = Path(__file__).parents[1]
SOURCES = ("LICENSE", "README.md", "conf", "pipeline", "pyproject.toml", "setup.py", "stages")
CONSTRAINTS = ("--constraint", str(ROOT / "constraints.txt"))
UV = Path(sys.executable).with_name("uv")
OTHERS = [path for path in os.environ.get("SIMGAP_PYTHONS", "").split(os.pathsep) if path]
ARM = "inertia: 0.05\nmotor: {resistance: 1.0, torque_constant: 0.05, gear_ratio: 10.0}\n"
GARBAGE = "raise RuntimeError('this is the file of another project') : : {"

pytestmark = pytest.mark.slow(minutes=3)


@dataclass(frozen=True)
class Installed:
    """An environment with the wheel, and a person's folder."""

    programs: Path
    folder: Path

    def run(self, *command: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
        """Run a program of the environment in the person's folder, and nothing of this process's environment."""
        plain = {
            key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV"))
        } | {"MPLBACKEND": "Agg"}
        return subprocess.run(
            [str(self.programs / command[0]), *command[1:]],
            cwd=folder or self.folder,
            env=plain,
            capture_output=True,
            text=True,
            check=False,
        )

    def said(self, *command: str, folder: Path | None = None) -> str:
        """Run a program that must end well, and return what it printed."""
        done = self.run(*command, folder=folder)
        assert done.returncode == 0, done.stderr
        return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy: building leaves litter beside what it builds."""
    folder = tmp_path_factory.mktemp("wheel")
    for name in SOURCES:
        source, target = ROOT / name, folder / "source" / name
        target.parent.mkdir(exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copyfile(source, target)
    build = ["-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder)]
    subprocess.run([sys.executable, *build, str(folder / "source")], check=True)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module", params=[sys.executable, *OTHERS])
def installed(
    request: pytest.FixtureRequest, wheel: Path, tmp_path_factory: pytest.TempPathFactory
) -> Installed:
    """A fresh environment with the wheel and what it depends on, without extras."""
    base = tmp_path_factory.mktemp("environment")
    subprocess.run([request.param, "-m", "venv", str(base / "env")], check=True)
    # By pip, which takes the build of this machine; compiling all of it would take longer than what the tests import.
    pip = [str(base / "env" / "bin" / "python"), "-m", "pip", "install", "--quiet", "--no-compile"]
    subprocess.run([*pip, *CONSTRAINTS, "torch"], check=True)
    return _with(str(wheel), base)


@pytest.fixture(scope="module")
def racing(installed: Installed, wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """A copy of it with the extra that the tutorial on the Python interface asks for; its python is used, no script."""
    base = tmp_path_factory.mktemp("racing")
    # Links in place of copies: whatever installs or compiles files here replaces them and writes into none.
    shutil.copytree(installed.programs.parent, base / "env", symlinks=True, copy_function=os.link)
    return _with(f"{wheel}[race]", base)


def _with(wanted: str, base: Path) -> Installed:
    """Install what is wanted into the environment of a folder, and make a person's folder beside it."""
    python = str(base / "env" / "bin" / "python")
    pip = [python, "-m", "pip", "install", "--quiet"]
    uv = [str(UV), "pip", "install", "--quiet", "--python", python] if UV.exists() else pip
    subprocess.run([*uv, *CONSTRAINTS, wanted], check=True)
    return Installed(base / "env" / "bin", _folder(base / "own"))


def _folder(folder: Path) -> Path:
    """Make a person's folder: a log, a platform file, and folders that are called like the project's."""
    for name in ("pipeline", "stages", "conf", "conf/platform", "my/platform"):
        (folder / name).mkdir(parents=True)
    for name in ("pipeline/__init__.py", "stages/__init__.py", "conf/config.yaml", "conf/platform/arm.yaml"):
        (folder / name).write_text(GARBAGE)
    (folder / "my" / "platform" / "arm.yaml").write_text(ARM)
    joint_recording(Plant(friction=0.3), runs=4).frame.to_csv(folder / "log.csv", index=False)
    return folder


def test_the_wheel_holds_one_package_with_its_configuration(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert {name.partition("/")[0] for name in names} == {"simgap", f"simgap-{version}.dist-info"}
    data = [path for part in ("conf", "pipeline") for path in (ROOT / part).rglob("*") if path.is_file()]
    wanted = {
        str(Path("simgap") / path.relative_to(ROOT)).replace("simgap/pipeline", "simgap")
        for path in data
        if "__pycache__" not in path.parts
    }
    assert wanted <= set(names)


def test_one_name_can_be_imported(installed: Installed, tmp_path: Path) -> None:
    code = (
        "from importlib.util import find_spec; from simgap.artifacts import CHECKOUT; "
        "print([name for name in ('simgap', 'pipeline', 'stages', 'conf', 'tests') if find_spec(name)], CHECKOUT)"
    )
    assert installed.said("python", "-c", code, folder=tmp_path) == "['simgap'] None\n"


def test_the_command_says_what_it_is(installed: Installed) -> None:
    assert installed.said("simgap", "--version").startswith("simgap ")
    assert "  diagnose " in installed.said("simgap", "--help")
    assert "Dry friction" in installed.said("simgap", "effects", "joint", "coulomb_friction")
    listed = installed.said("simgap", "effects")
    assert all(kind in listed for kind in ("joint", "quadrotor", "swerve"))


def test_the_configuration_is_that_of_the_package(installed: Installed) -> None:
    shown = installed.said("simgap", "diagnose", "--cfg", "platform=servo", "gap.horizon=0.4")
    assert "horizon: 0.4" in shown
    assert "inertia:" in shown
    assert installed.said("python", "-m", "simgap.stages.diagnose", "--cfg").startswith("name: default")


def test_a_log_is_diagnosed_and_nothing_else_is_written(installed: Installed) -> None:
    done = installed.said(
        "simgap", "diagnose", "--config-dir", "my", "platform=arm", "recording=log.csv", "output=answer",
        "gap.effects=[coulomb_friction,viscous_friction]",
    )  # fmt: skip
    assert "verdict: missing_physics" in done
    document = read_diagnosis(installed.folder / "answer" / "diagnosis.json", "joint")
    assert [effect["name"] for effect in document["effects"]] == ["coulomb_friction"]
    assert (installed.folder / "answer" / "report.html").is_file()
    assert (installed.folder / "answer" / "simulator" / "simulator.yaml").is_file()
    own = {path.name for path in installed.folder.iterdir()}
    assert own == {"pipeline", "stages", "conf", "my", "log.csv", "answer"}


@pytest.mark.parametrize(
    ("command", "line"),
    [
        (
            "reproduce",
            "it works in a clone of the repository only, with the command that `make install` puts there; "
            "clone it, run make install in it, and call .venv/bin/simgap there",
        ),
        (
            "train_policy platform=racer train_policy=racing_quick",
            "needs tensordict; pip install 'simgap[race]'",
        ),
        ("diagnose recording=log.csv tracking=local", "needs mlflow; pip install 'simgap[track]'"),
        (
            "clean recording=log.csv hydra/launcher=joblib -m seed=1,2",
            "needs matplotlib; pip install 'simgap[sweep]'",
        ),
    ],
)
def test_what_is_not_there_is_one_line(installed: Installed, command: str, line: str) -> None:
    name, *arguments = command.split()
    done = (
        installed.run("simgap", name, "--config-dir", "my", *arguments)
        if arguments
        else installed.run("simgap", name)
    )
    assert (done.returncode, done.stderr) == (2, f"simgap {name}: {line}\n")


def test_the_tutorial_on_the_python_interface_runs_on_the_wheel(racing: Installed) -> None:
    """From an installation to a rollout of the diagnosed simulator and an episode of a race."""
    racing.said("python", str(ROOT / "docs" / "tutorials" / "api.py"))
    assert not (racing.folder / "mlflow.db").exists()
