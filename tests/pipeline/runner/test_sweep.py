"""Many configurations of one stage in one command."""

import ast
import shutil
from pathlib import Path
from types import ModuleType

import pytest

from simgap.comparison.comparison import Comparison
from simgap.runner import completion
from simgap.runner.command import run_command
from simgap.runner.sweep import job_name
from simgap.tracking.store import open_store
from simgap.tracking.tracker import PARENT_TAG

UNTRACKED = "tracking.enabled=false"
COMPARED = ["comparison.json", "comparison.md", "comparison.svg"]


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
@pytest.mark.parametrize("launcher", ["joblib", "submitit_local"])
def test_launched_jobs_give_what_serial_ones_give(tiny: ModuleType, launcher: str) -> None:
    package = f"hydra_plugins.hydra_{launcher.partition('_')[0]}_launcher"
    pytest.importorskip(package, reason=f"{launcher} is not installed: pip install -e '.[cluster]'")
    sweep = ["-m", "seed=1,2,3", UNTRACKED]
    assert run_command(tiny.tiny_stage, [*sweep, "output=serial"]) == 0
    assert run_command(tiny.tiny_stage, [*sweep, "output=launched", f"hydra/launcher={launcher}"]) == 0
    assert len(results(Path("serial"))) == 3
    assert results(Path("serial")) == results(Path("launched"))
    serial, launched = (Comparison.read(Path(folder, "comparison")) for folder in ("serial", "launched"))
    assert [job.metrics for job in serial.jobs] == [job.metrics for job in launched.jobs]


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
    comparison = Comparison.read(Path("out/comparison"))
    assert [job.values for job in comparison.jobs] == [{"drawing.amount": 1}]
    assert [reason.partition(": ")[0] for reason in comparison.failed] == [
        "drawing.amount=-1",
        "drawing.amount=x",
    ]


def test_a_typo_in_a_sweep_is_one_line(tiny: ModuleType, capfd: pytest.CaptureFixture[str]) -> None:
    assert run_command(tiny.tiny_stage, ["-m", "platform=sparow,eagle", UNTRACKED]) == 2
    assert (
        capfd.readouterr().err
        == "simgap tiny_stage: platform: there is no 'sparow'; did you mean 'sparrow'?\n"
    )


def test_all_jobs_are_children_of_one_parent(tiny: ModuleType, store: str) -> None:
    for _ in range(2):  # the second time they are done already
        assert run_command(tiny.tiny_stage, ["-m", "drawing.amount=1,2", f"tracking.uri={store}"]) == 0
    client, experiment = open_store(store)
    runs = client.search_runs([experiment])
    (parent,) = [run for run in runs if PARENT_TAG in run.data.tags]
    children = [run for run in runs if run is not parent]
    assert sorted(run.info.run_name for run in children) == ["drawing.amount=1", "drawing.amount=2"]
    assert {run.data.tags["mlflow.parentRunId"] for run in children} == {parent.info.run_id}
    logged = client.list_artifacts(parent.info.run_id, "comparison")
    assert sorted(Path(file.path).name for file in logged) == COMPARED


def test_a_sweep_that_grows_has_all_its_jobs_under_its_parent(tiny: ModuleType, store: str) -> None:
    for seeds in ("1,2", "1,2,3"):
        assert run_command(tiny.tiny_stage, ["-m", f"seed={seeds}", f"tracking.uri={store}"]) == 0
    client, experiment = open_store(store)
    runs = {run.info.run_id: run for run in client.search_runs([experiment])}
    children = [run for run in runs.values() if "mlflow.parentRunId" in run.data.tags]
    assert sorted(run.info.run_name for run in children) == [f"seed={n}" for n in (1, 1, 2, 2, 3)]
    assert all("sum" in run.data.metrics for run in children)


def test_the_jobs_of_a_sweep_are_compared(tiny: ModuleType) -> None:
    sweep = ["-m", "drawing.amount=1,2", "seed=4,5", UNTRACKED]
    assert run_command(tiny.tiny_stage, sweep) == 0
    folder = Path("artifacts/default/sweeps/tiny_stage")
    assert sorted(path.name for path in (folder / "comparison").iterdir()) == COMPARED
    comparison = Comparison.read(folder / "comparison")
    assert comparison.command == f"simgap tiny_stage {' '.join(sweep)}"
    assert [(job.values, job.seed) for job in comparison.jobs] == [
        ({"drawing.amount": amount}, seed) for amount in (1, 2) for seed in (4, 5)
    ]
    for job in comparison.jobs:
        name = f"drawing.amount={job.values['drawing.amount']},seed={job.seed}"
        assert job.metrics == {"sum": sum(ast.literal_eval(results(folder)[name])), "undefined": None}


def test_a_preset_names_the_folder_and_the_jobs_that_it_sweeps(tiny: ModuleType) -> None:
    assert run_command(tiny.tiny_stage, ["-m", "+experiment=pair", "drawing.amount=3,4", UNTRACKED]) == 0
    folder = Path("artifacts/default/sweeps/pair")
    assert sorted(results(folder)) == [f"seed={s},drawing.amount={n}" for s in (1, 2) for n in (3, 4)]
    assert Comparison.read(folder / "comparison").results.title == "A pair"


def test_a_preset_run_part_by_part_puts_every_job_where_the_whole_would(tiny: ModuleType) -> None:
    for seed in (1, 2):
        sweep = ["-m", "+experiment=pair", "drawing.amount=3,4", f"seed={seed}", UNTRACKED]
        assert run_command(tiny.tiny_stage, sweep) == 0
    folder = Path("artifacts/default/sweeps/pair")
    assert sorted(results(folder)) == [f"seed={s},drawing.amount={n}" for s in (1, 2) for n in (3, 4)]
    assert [job.values for job in Comparison.read(folder / "comparison").jobs] == [
        {"drawing.amount": amount} for amount in (3, 4)
    ]


def test_the_whole_after_its_parts_knows_what_each_job_is(tiny: ModuleType) -> None:
    for amount in (3, 4):
        part = ["-m", "+experiment=pair", f"drawing.amount={amount}", "seed=1,2", UNTRACKED]
        assert run_command(tiny.tiny_stage, part) == 0
    whole = ["-m", "+experiment=pair", "drawing.amount=3,4", "seed=1,2", UNTRACKED]
    assert run_command(tiny.tiny_stage, whole) == 0
    jobs = Comparison.read(Path("artifacts/default/sweeps/pair/comparison")).jobs
    assert [(job.seed, job.values) for job in jobs] == [
        (seed, {"drawing.amount": amount}) for seed in (1, 2) for amount in (3, 4)
    ]


def written(folder: Path) -> dict[str, int]:
    return {path.parent.name: path.stat().st_ino for path in folder.rglob("draws")}


@pytest.mark.slow
def test_what_is_done_is_not_run_again(tiny: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("flight.csv").write_text("t\n")
    sweep = ["-m", "drawing.amount=1,2", "recording=flight.csv", UNTRACKED, "output=out"]

    def repeated(*more: str) -> list[str]:
        """Return the jobs that are run when the sweep is started again."""
        before = written(Path("out"))
        assert run_command(tiny.tiny_stage, [*sweep, *more]) == 0
        return sorted(name for name, place in written(Path("out")).items() if before.get(name) != place)

    both = ["drawing.amount=1", "drawing.amount=2"]
    assert repeated() == both
    assert repeated() == []
    assert repeated("results.title=Other") == []
    shutil.rmtree("out/drawing.amount=2")
    assert repeated() == both[1:]
    assert repeated("drawing.scale=3.0") == both
    Path("flight.csv").write_text("t,x\n")
    assert repeated("drawing.scale=3.0") == both
    path = Path("out/drawing.amount=1/job.json")
    path.write_text(
        path.read_text().replace(completion.loaded_code()["pipeline/runner/run.py"], "other code")
    )
    assert repeated("drawing.scale=3.0") == both[:1]
    path.write_text("{half")
    assert repeated("drawing.scale=3.0") == both[:1]


def test_a_comparison_names_the_machines_that_ran_the_jobs(tiny: ModuleType) -> None:
    sweep = ["-m", "drawing.amount=1,2", UNTRACKED, "output=out"]
    assert run_command(tiny.tiny_stage, sweep) == 0
    own = Comparison.read(Path("out/comparison")).machine
    path = Path("out/drawing.amount=1/job.json")
    path.write_text(path.read_text().replace(f'"{own}"', '"another machine"'))
    assert run_command(tiny.tiny_stage, sweep) == 0
    assert Comparison.read(Path("out/comparison")).machine == f"another machine; {own}"


def test_the_name_of_a_job_is_the_name_of_a_directory() -> None:
    assert job_name(["++model.length=5", "recording=/a b/c.csv"]) == "model.length=5,recording=_a_b_c.csv"
    first, second = (job_name([f"x={'1' * 300}{end}"]) for end in "ab")
    assert first != second
    assert len(first) < 255
    assert job_name([]) == "job"
