"""What is logged, and that logging never stands in the way."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from simgap.tracking import Tracker, Tracking
from simgap.tracking.liveness import is_dead, process
from simgap.tracking.store import open_store, store_uri
from simgap.tracking.tracker import PARENT_TAG, STAGE_TAG


def tracker(uri: str, stage: str = "clean", key: str = "key", **keywords: object) -> Tracker:
    return Tracker(Tracking(uri=uri), stage, "branch", key, **keywords)  # type: ignore[arg-type]


def runs(uri: str) -> tuple[list, list]:
    client, experiment = open_store(uri)
    found = client.search_runs([experiment])
    parents = [run for run in found if PARENT_TAG in run.data.tags]
    return parents, [run for run in found if STAGE_TAG in run.data.tags]


def test_a_stage_is_a_child_of_its_reproduction(store: str) -> None:
    for stage in ("clean", "diagnose"):
        one = tracker(store, stage, parameters={"seed": 1, "gap": {"margin": 0.5, "effects": None}})
        one.log_input("artifacts/branch/flight (1).csv", "0123")
        one.log_metrics({"samples": 7.0})
        one.log_metrics({"loss": 2.0}, step=0)
        one.log_metrics({"loss": 1.0}, step=1)
        one.log_results({"gap_closed": 0.9})
        one.finish(True)
    (parent,), children = runs(store)
    assert parent.info.run_name == "branch"
    assert parent.data.metrics == {"gap_closed": 0.9}
    assert {child.data.tags[STAGE_TAG] for child in children} == {"clean", "diagnose"}
    for child in children:
        assert child.data.tags["mlflow.parentRunId"] == parent.info.run_id
        assert child.data.tags["input.artifacts/branch/flight _1_.csv"] == "0123"
        assert child.data.params == {"seed": "1", "gap.margin": "0.5", "gap.effects": "None"}
        assert child.data.metrics == {"samples": 7.0, "loss": 1.0}
        assert child.info.status == "FINISHED"


def test_a_repeated_run_takes_the_place_of_the_earlier_one(store: str) -> None:
    for value in (1.0, 2.0):
        one = tracker(store)
        one.log_metrics({"samples": value})
        one.finish(True)
    parents, (child,) = runs(store)
    assert len(parents) == 1
    assert child.data.metrics == {"samples": 2.0}


def test_another_configuration_is_another_reproduction(store: str) -> None:
    for key in ("one", "other"):
        tracker(store, key=key).finish(True)
    parents, children = runs(store)
    assert (len(parents), len(children)) == (2, 2)


def test_a_run_lasts_as_long_as_its_stage(store: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The store is opened late; what was done before counts too, and a repeated run does not count the days between."""
    clock = [1_000.0]
    monkeypatch.setattr("time.time", lambda: clock[0])
    for start in (1_000.0, 90_000.0):
        clock[0] = start
        one = tracker(store)
        clock[0] += 30.0
        one.log_metrics({"samples": 1.0})
        one.finish(True)
        (parent,), (child,) = runs(store)
        for run in (parent, child):
            assert (run.info.start_time, run.info.end_time) == (start * 1000, (start + 30.0) * 1000)


def test_other_stages_keep_the_parent_of_a_repeated_one(store: str) -> None:
    for stage in ("clean", "diagnose", "clean"):
        tracker(store, stage).finish(True)
    parents, children = runs(store)
    assert len(parents) == 1
    assert sorted(child.data.tags[STAGE_TAG] for child in children) == ["clean", "diagnose"]


def test_what_came_out_is_a_column_of_run_and_parent(store: str) -> None:
    one = tracker(store)
    one.describe({"verdict": "missing_physics", "effects": "rotor_drag 0.98"})
    one.finish(True)
    (parent,), (child,) = runs(store)
    for run in (parent, child):
        assert run.data.tags["verdict"] == "missing_physics"
        assert run.data.tags["effects"] == "rotor_drag 0.98"


def test_an_interrupted_run_is_marked_as_killed_with_its_parent(store: str) -> None:
    one = tracker(store)
    one.log_metrics({"samples": 1.0})
    one.finish(False, killed=True)
    (parent,), (child,) = runs(store)
    assert (parent.info.status, child.info.status) == ("KILLED", "KILLED")


def test_runs_of_a_dead_process_are_marked_when_the_next_one_begins(store: str) -> None:
    code = (
        "import os\nfrom simgap.tracking import Tracker, Tracking\n"
        f"one = Tracker(Tracking(uri={store!r}), 'clean', 'branch', 'key')\n"
        "one.log_metrics({'samples': 1.0})\nos.kill(os.getpid(), 9)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=False)
    alive = tracker(store, key="alive")
    alive.log_metrics({"samples": 1.0})
    tracker(store, key="next").finish(True)
    parents, children = runs(store)
    found = {run.data.tags[PARENT_TAG]: run for run in parents}
    assert {key: run.info.status for key, run in found.items()} == {
        "key": "KILLED",
        "alive": "RUNNING",
        "next": "FINISHED",
    }
    killed = next(child for child in children if child.info.status == "KILLED")
    assert killed.data.tags["mlflow.parentRunId"] == found["key"].info.run_id
    logged = open_store(store)[0].get_metric_history(killed.info.run_id, "samples")
    assert killed.info.end_time == logged[-1].timestamp


def test_a_process_is_known_to_have_ended_on_this_machine_only() -> None:
    assert not is_dead(process())
    assert not is_dead("elsewhere 0 1")
    host = process().split(" ", 1)[0]
    assert is_dead(f"{host} another-boot {os.getpid()}")


def test_a_failure_before_anything_was_logged_leaves_no_trace(tmp_path: Path) -> None:
    one = tracker(f"sqlite:///{tmp_path}/runs.db")
    one.log_input("flight.csv", "0123")
    one.finish(False)
    assert list(tmp_path.iterdir()) == []


def test_a_failure_later_is_recorded(store: str) -> None:
    one = tracker(store)
    one.log_metrics({"samples": 1.0})
    one.finish(False)
    _, (child,) = runs(store)
    assert child.info.status == "FAILED"


def test_figures_are_logged(store: str) -> None:
    from matplotlib.figure import Figure

    one = tracker(store)
    one.log_figure(Figure(), "coverage")
    one.finish(True)
    client, _ = open_store(store)
    assert [file.path for file in client.list_artifacts(one.run_id() or "")] == ["coverage.png"]


@pytest.mark.parametrize(
    "where", ["sqlite:////proc/absent/runs.db", "sqlite:////dev/null/runs.db", "nonsense://x"]
)
def test_tracking_that_cannot_work_warns_once_and_goes_on(
    where: str, capsys: pytest.CaptureFixture[str]
) -> None:
    one = tracker(where)
    one.log_metrics({"samples": 1.0})
    one.log_metrics({"samples": 2.0})
    one.finish(True)
    assert one.run_id() is None
    err = capsys.readouterr().err
    assert err.startswith(f"warning: this run is not tracked in {where}: ")
    assert err.count("\n") == 1


def test_tracking_that_is_off_does_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mlflow", None)  # importing it would raise
    one = Tracker.none()
    one.log_metrics({"samples": 1.0})
    one.finish(True)
    assert one.run_id() is None


def test_a_half_made_database_does_not_stay(tmp_path: Path) -> None:
    """A process killed while it creates the store leaves a file of another name, which the next one replaces."""
    (tmp_path / "runs.db.partial").write_bytes(b"SQLite format 3\0 and then nothing")
    store = f"sqlite:///{tmp_path}/runs.db"
    tracker(store).finish(True)
    assert len(runs(store)[1]) == 1
    assert not (tmp_path / "runs.db.partial").exists()


def test_the_store_lies_in_the_project_wherever_one_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    root = Path(__file__).parents[3]
    assert store_uri(None) == f"sqlite:///{root}/mlflow.db"
    assert store_uri("sqlite:///other.db") == f"sqlite:///{root}/other.db"
    assert store_uri("sqlite:////tmp/other.db") == "sqlite:////tmp/other.db"
    assert store_uri("http://localhost:5000") == "http://localhost:5000"
