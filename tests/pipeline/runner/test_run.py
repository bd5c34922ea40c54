"""What a stage is given."""

import hashlib
import pickle
import random
import runpy
import signal
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

import numpy
import pytest

from simgap.errors import InputError
from simgap.runner import StageConfig, StageRun, seed_everything
from simgap.runner.compose import typed
from simgap.tracking.store import open_store


def test_a_stage_is_a_plain_function(tiny: ModuleType, tmp_path: Path) -> None:
    tiny.tiny_stage(tiny.TinyStage(), StageRun(tmp_path))
    assert (tmp_path / "draws").is_file()
    assert tiny.tiny_stage.__doc__.startswith("Draw some numbers.")


def test_inputs_are_there_and_hashed(tmp_path: Path) -> None:
    run = StageRun(tmp_path)
    (tmp_path / "flight.csv").write_text("t\n")
    assert run.input(tmp_path / "flight.csv") == tmp_path / "flight.csv"
    assert run.inputs == {str(tmp_path / "flight.csv"): hashlib.sha256(b"t\n").hexdigest()}
    with pytest.raises(InputError, match=r"absent.csv: does not exist; check the path$"):
        run.input(tmp_path / "absent.csv")
    with pytest.raises(InputError, match=r"does not exist; check the path, or run simgap clean first"):
        run.input(tmp_path / "train" / "clean" / "recording.parquet")


def test_a_doubt_is_one_line_on_standard_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = StageRun(tmp_path)
    run.warn("run 'a':\n  degrees?")
    assert capsys.readouterr().err == "warning: run 'a': degrees?\n"
    assert run.warnings == ["run 'a': degrees?"]


def test_a_stage_with_nothing_to_do_says_so_and_leaves_empty_metrics(tmp_path: Path, caplog) -> None:
    run = StageRun(tmp_path)
    with caplog.at_level("INFO", "simgap"):
        run.leave_out("sum: there is nothing to add")
    run.write_metrics()
    assert caplog.messages == ["sum: there is nothing to add"]
    assert (tmp_path / "metrics.json").read_text() == "{}\n"


def test_metrics_do_not_overwrite_what_the_stage_wrote(tmp_path: Path) -> None:
    run = StageRun(tmp_path)
    run.log_metrics({"loss": 1.0}, step=3)
    run.write_metrics()
    assert not (tmp_path / "metrics.json").exists()
    (tmp_path / "metrics.json").write_text("mine")
    run.log_metrics({"loss": 1.0})
    run.write_metrics()
    assert (tmp_path / "metrics.json").read_text() == "mine"


def test_artifacts_of_a_branch_lie_together() -> None:
    config = typed(StageConfig, {"name": "flight", "artifacts": "artifacts/flight", "unread": 1})
    assert config.artifact("clean", "recording.parquet") == Path("artifacts/flight/clean/recording.parquet")


@dataclass
class Part:
    length: float = 1.0


@dataclass
class Whole(StageConfig):
    part: Part = field(default_factory=Part)
    free: dict[str, int] = field(default_factory=dict)


def test_the_configuration_arrives_as_its_dataclasses() -> None:
    config = typed(Whole, {"part": {"length": 3}, "free": {"a": 1}})
    assert config == Whole(part=Part(3.0), free={"a": 1}, artifacts="artifacts/default")
    assert type(config.part.length) is float
    assert type(config.free) is dict


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"part": {"lenght": 1}}, "part: unknown key 'lenght'; did you mean 'length'?"),
        ({"part": None}, "part: "),
        ({"part": 3}, "part: "),
        ({"free": {"a": "x"}}, "free.a: Value 'x' of type 'str' could not be converted to Integer"),
    ],
)
def test_what_does_not_fit_is_said_under_its_key(values: dict, message: str) -> None:
    with pytest.raises(InputError) as caught:
        typed(Whole, values)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_one_seed_for_every_generator() -> None:
    def draw() -> tuple[float, float, float]:
        seed_everything(5)
        torch = sys.modules["torch"]
        return random.random(), numpy.random.random(), torch.rand(1).item()  # noqa: NPY002

    pytest.importorskip("torch")
    assert draw() == draw()
    seed_everything(2**40)  # more than numpy takes


def test_a_stage_travels_to_a_worker_by_name(tiny: ModuleType) -> None:
    find, name = tiny.tiny_stage.__reduce__()
    assert find(*name) is tiny.tiny_stage
    assert len(pickle.dumps(tiny.tiny_stage)) < 200  # the name alone travels, not the function


def test_a_stage_runs_as_a_module(tiny: ModuleType) -> None:
    command = [sys.executable, "-m", "tiny_stage", "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("usage: simgap tiny_stage ")
    assert runpy.run_path(str(tiny.__file__))["tiny_stage"].name == "tiny_stage"


def test_torch_is_not_loaded_for_a_cheap_stage(tiny: ModuleType) -> None:
    code = (
        "import sys, tempfile; from tiny_stage import *; from simgap.runner import *; t = tiny_stage;"
        "seed_everything(1); t(TinyStage(), StageRun(tempfile.mkdtemp()));"
        "sys.exit(any(name in sys.modules for name in ('torch', 'mlflow', 'pandas')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_stage_leaves_nothing_and_its_run_is_killed(
    number: int, code: int, tiny: ModuleType, store: str
) -> None:
    program = (
        "import os, signal, sys\nimport tiny_stage\nfrom simgap.runner.command import run_command\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a shell ignores it in the background
        "def interrupt(config, run):\n    run.log_metrics({'samples': 1.0})\n"
        f"    os.kill(os.getpid(), {int(number)})\n    import time\n    time.sleep(20)\n"
        "tiny_stage.tiny_stage.function = interrupt\n"
        f"sys.exit(run_command(tiny_stage.tiny_stage, ['tracking.uri={store}', 'recording=my flight.csv']))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    assert list(Path("artifacts").rglob("*.json")) == []
    client, experiment = open_store(store)
    found = client.search_runs([experiment])
    assert [run.info.status for run in found] == ["KILLED", "KILLED"]
    assert {run.info.run_name for run in found} == {"my flight", "tiny_stage"}
