"""What `simgap stages` says of a branch."""

from pathlib import Path

import pytest
import yaml

from simgap.artifacts import PROJECT_ROOT, project
from simgap.errors import InputError
from simgap.runner import pipeline
from simgap.runner.reproduction import reproduce_target
from simgap.stages.stages import stages

CONFIG = "[core]\n    analytics = false\n    no_scm = true\n"
FOLDER = "artifacts/${item}"
FILE = {
    "vars": [{"branches": ["swift", "heron"]}],
    "stages": {
        "record": {"cmd": f"mkdir -p {FOLDER} && cat source > {FOLDER}/record", "deps": ["source"]},
        "clean": {"cmd": f"wc -c < {FOLDER}/record > {FOLDER}/clean", "deps": [f"{FOLDER}/record"]},
        "report": {"cmd": f"cp {FOLDER}/clean {FOLDER}/report", "deps": [f"{FOLDER}/clean"]},
    },
}


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a project of three stages, the first of which was reproduced."""
    monkeypatch.setenv("DVC_SITE_CACHE_DIR", str(tmp_path / "site"))
    folder = tmp_path / "project"
    (folder / ".dvc").mkdir(parents=True)
    (folder / ".dvc" / "config").write_text(CONFIG)
    content = {**FILE, "stages": {}}
    for name, entry in FILE["stages"].items():
        outs = {"outs": [f"{FOLDER}/{name}"]}
        content["stages"][name] = {"foreach": "${branches}", "do": entry | outs}
    (folder / "dvc.yaml").write_text(yaml.safe_dump(content, sort_keys=False))
    (folder / "source").write_text("one")
    monkeypatch.setattr(project, "CHECKOUT", folder)
    return folder


def states(root: Path) -> dict[str, str]:
    return {name: found.state for name, found in pipeline.freshness(root, "swift").items()}


def test_a_stage_is_fresh_changed_waiting_or_new(root: Path) -> None:
    assert states(root) == dict.fromkeys(("record", "clean", "report"), "never ran")
    assert reproduce_target("clean@swift", root) == 0
    assert states(root) == {"record": "fresh", "clean": "fresh", "report": "never ran"}
    assert reproduce_target("report@swift", root) == 0
    assert set(states(root).values()) == {"fresh"}
    (root / "source").write_text("two")
    # The recording will differ; whether its length does is not known before.
    assert states(root) == {"record": "would run", "clean": "may run", "report": "may run"}
    assert pipeline.freshness(root, "swift")["record"].reason == "source modified"
    assert pipeline.freshness(root, "swift")["clean"].reason == "after record"


def test_the_table_is_of_the_branch_that_was_worked_on(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert reproduce_target("record@heron", root) == 0
    capsys.readouterr()
    stages()
    head, place, _, *rows = capsys.readouterr().out.splitlines()
    assert head == "branch heron: `simgap reproduce heron` runs 2 of 3 stages"
    assert place == "output of a stage: artifacts/heron/STAGE"
    assert [row.split()[0] for row in rows] == ["stage", "record", "clean", "report"]
    assert rows[1].split()[1] == "fresh"
    assert "  Get the recording: import a dataset" in rows[1]
    assert rows[2].split()[1:4] == ["never", "ran", "-"]


def test_the_steps_of_the_project_stand_behind_what_they_read() -> None:
    order = pipeline.steps(PROJECT_ROOT)
    names = [step.name for step in order]
    assert names[0] == "configure"
    assert all(names.index(other) < names.index(step.name) for step in order for other in step.reads)
    assert next(step.reads for step in order if step.name == "deploy") == (
        "configure",
        "sysid",
        "build_sim",
        "diagnose",
        "train_policy",
        "profile",
        "train_detector",
    )


def test_mistakes_are_one_line(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="no branch 'swiff'; did you mean 'swift'"):
        stages("swiff")
    (root / "dvc.lock").write_text("schema: '2.0'\nstages: {")
    with pytest.raises(InputError):
        stages("swift")
    monkeypatch.setattr(project, "CHECKOUT", None)
    with pytest.raises(InputError, match="it works in a clone of the repository only"):
        stages()
