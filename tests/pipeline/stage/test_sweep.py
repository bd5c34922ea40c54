"""Many configurations of one stage in one command."""

from pathlib import Path
from types import ModuleType

import pytest

from pipeline.stage.command import run_command
from pipeline.stage.sweep import job_name
from pipeline.tracking.store import open_store
from pipeline.tracking.tracker import PARENT_TAG

UNTRACKED = "tracking.enabled=false"


def results(folder: Path) -> dict[str, str]:
    return {path.parent.name: path.read_text() for path in sorted(folder.rglob("draws"))}


def test_every_job_has_a_directory_of_its_own(tiny: ModuleType, capfd: pytest.CaptureFixture[str]) -> None:
    assert (
        run_command(tiny.tiny_stage, ["-m", "drawing.amount=1,2", "platform=sparrow,eagle", UNTRACKED]) == 0
    )
    assert sorted(results(Path("artifacts/default/sweeps/tiny_stage"))) == [
        f"drawing.amount={amount},platform={name}" for amount in (1, 2) for name in ("eagle", "sparrow")
    ]
    assert capfd.readouterr().err == ""


@pytest.mark.slow
def test_parallel_jobs_give_what_serial_ones_give(tiny: ModuleType) -> None:
    sweep = ["-m", "seed=1,2,3", UNTRACKED]
    assert run_command(tiny.tiny_stage, [*sweep, "output=serial"]) == 0
    assert run_command(tiny.tiny_stage, [*sweep, "output=parallel", "hydra/launcher=joblib"]) == 0
    assert len(results(Path("serial"))) == 3
    assert results(Path("serial")) == results(Path("parallel"))


def test_jobs_that_cannot_run_are_named_and_the_others_run(
    tiny: ModuleType, capfd: pytest.CaptureFixture[str]
) -> None:
    code = run_command(tiny.tiny_stage, ["-m", "drawing.amount=-1,1,x", UNTRACKED, "output=out"])
    assert code == 2
    assert capfd.readouterr().err.splitlines() == [
        "simgap tiny_stage: drawing.amount=-1: drawing.amount: must not be negative; give another one",
        "simgap tiny_stage: drawing.amount=x: drawing.amount: Value 'x' of type 'str' could not be converted"
        " to Integer; correct the value",
    ]
    assert list(results(Path("out"))) == ["drawing.amount=1"]


def test_a_typo_in_a_sweep_is_one_line(tiny: ModuleType, capfd: pytest.CaptureFixture[str]) -> None:
    assert run_command(tiny.tiny_stage, ["-m", "platform=sparow,eagle", UNTRACKED]) == 2
    assert (
        capfd.readouterr().err
        == "simgap tiny_stage: platform: there is no 'sparow'; did you mean 'sparrow'?\n"
    )


def test_all_jobs_are_children_of_one_parent(tiny: ModuleType, store: str) -> None:
    for _ in range(2):  # the second time replaces the first
        assert run_command(tiny.tiny_stage, ["-m", "seed=1,2", f"tracking.uri={store}"]) == 0
    client, experiment = open_store(store)
    runs = client.search_runs([experiment])
    (parent,) = [run for run in runs if PARENT_TAG in run.data.tags]
    children = [run for run in runs if run is not parent]
    assert sorted(run.info.run_name for run in children) == ["seed=1", "seed=2"]
    assert {run.data.tags["mlflow.parentRunId"] for run in children} == {parent.info.run_id}


def test_the_name_of_a_job_is_the_name_of_a_directory() -> None:
    assert job_name(["++model.length=5", "recording=/a b/c.csv"]) == "model.length=5,recording=_a_b_c.csv"
    first, second = (job_name([f"x={'1' * 300}{end}"]) for end in "ab")
    assert first != second
    assert len(first) < 255
    assert job_name([]) == "job"
