"""`dvc repro` that was killed, and starts again."""

import fcntl
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from simgap.errors import InputError
from simgap.runner.reproduction import list_metrics, reproduce_target

CONFIG = "[core]\n    analytics = false\n    no_scm = true\n"
STAGES = """
stages:
  first:
    cmd: >
      echo first >> log && mkdir -p out && echo half > out/first && sleep ${seconds} &&
      echo whole > out/first
    outs: [out/first]
  last:
    cmd: echo last >> log && cp out/first out/last
    deps: [out/first]
    outs: [out/last]
vars: [{seconds: SECONDS}]
"""

RUN = """
import sys
from pathlib import Path
from simgap.runner.reproduction import list_metrics, reproduce_target
sys.exit(reproduce_target("last", Path(sys.argv[1])))
"""


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("DVC_SITE_CACHE_DIR", str(tmp_path / "site"))
    root = tmp_path / "project"
    (root / ".dvc" / "tmp").mkdir(parents=True)
    (root / ".dvc" / "config").write_text(CONFIG)
    (root / "dvc.yaml").write_text(STAGES.replace("SECONDS", "0"))
    return root


def log(project: Path) -> list[str]:
    return (project / "log").read_text().split()


@pytest.mark.slow
def test_the_second_time_nothing_runs(project: Path) -> None:
    assert reproduce_target("last", project) == 0
    assert reproduce_target("last", project) == 0
    assert log(project) == ["first", "last"]


@pytest.mark.slow
def test_dvc_makes_no_remarks_on_its_lock_file_and_remotes(
    project: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert reproduce_target("last", project) == 0
    said = "".join(capfd.readouterr())
    assert "Running stage 'last'" in said
    assert "lock file" not in said
    assert "dvc push" not in said


def metrics_shown(project: Path) -> str:
    program = str(Path(sys.executable).parent / "dvc")
    done = subprocess.run(
        [program, "metrics", "show"], cwd=project, capture_output=True, text=True, check=True
    )
    return done.stdout + done.stderr


@pytest.mark.slow
def test_metrics_are_shown_of_what_was_reproduced_and_nothing_is_said_before(project: Path) -> None:
    assert metrics_shown(project) == ""
    report = project / "artifacts" / "swift" / "report"
    report.mkdir(parents=True)
    (report / "metrics.json").write_text('{"gap_closed": 0.5}')
    list_metrics(project)
    head, row = metrics_shown(project).splitlines()
    assert (head.split(), row.split()) == (
        ["Path", "gap_closed"],
        ["artifacts/swift/report/metrics.json", "0.5"],
    )


@pytest.mark.slow
def test_what_a_killed_one_left_does_not_stand_in_the_way(project: Path) -> None:
    """The lock file is cut short, and another process has the number of the one that claims a file."""
    assert reproduce_target("last", project) == 0
    lock_file = project / "dvc.lock"
    lock_file.write_text(lock_file.read_text()[:120])
    stranger = subprocess.Popen(["sleep", "60"])
    claim = {"pid": stranger.pid, "cmd": "dvc repro"}
    (project / ".dvc" / "tmp" / "rwlock").write_text(json.dumps({"write": {str(project / "out"): claim}}))
    try:
        assert reproduce_target("last", project) == 0
    finally:
        stranger.kill()
        stranger.wait()
    assert (project / "out" / "last").read_text() == "whole\n"


@pytest.mark.slow
def test_killed_in_the_middle_it_starts_again(project: Path) -> None:
    (project / "dvc.yaml").write_text(STAGES.replace("SECONDS", "30"))
    process = subprocess.Popen([sys.executable, "-c", RUN, str(project)], start_new_session=True)
    deadline = time.monotonic() + 30
    while not (project / "out" / "first").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert (project / "out" / "first").read_text() == "half\n"
    (project / "dvc.yaml").write_text(STAGES.replace("SECONDS", "0"))
    assert reproduce_target("last", project) == 0
    assert (project / "out" / "last").read_text() == "whole\n"


@pytest.mark.slow
def test_a_stage_that_fails_is_reported(project: Path) -> None:
    (project / "dvc.yaml").write_text("stages:\n  last:\n    cmd: exit 3\n")
    assert reproduce_target("last", project) != 0


@pytest.mark.slow
def test_one_reproduction_waits_for_the_other(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    descriptor = os.open(project / ".dvc" / "tmp" / "reproduce.lock", os.O_RDWR | os.O_CREAT)
    fcntl.flock(descriptor, fcntl.LOCK_EX)
    waiting = threading.Thread(target=reproduce_target, args=("last", project))
    waiting.start()
    waiting.join(timeout=1.0)
    assert waiting.is_alive()
    assert not (project / "log").exists()
    os.close(descriptor)
    waiting.join()
    assert log(project) == ["first", "last"]
    assert "another reproduction is still running here" in capsys.readouterr().out


def test_a_read_only_project_is_said_in_one_line() -> None:
    with pytest.raises(InputError, match=r"^/proc/.*reproduce.lock: cannot be written"):
        reproduce_target("last", Path("/proc"))
