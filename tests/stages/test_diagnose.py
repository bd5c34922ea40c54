"""`simgap diagnose` on a person's own file."""

import html
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

import simgap
from simgap.recordings.recording import Recording, write_recording
from simgap.runner.command import main
from simgap.simulation import read_simulator
from simgap.stages.diagnose import diagnose
from simgap.tracking.store import open_store
from tests.contract_checker import read_diagnosis
from tests.pipeline.gap.recordings import Plant, joint_recording

PLATFORM = {
    "kind": "joint",
    "inertia": 0.05,
    "motor": {"resistance": 1.0, "torque_constant": 0.05, "gear_ratio": 10.0},
}

FEW = ("gap.effects=[coulomb_friction, viscous_friction]", "gap.resamples=50", "gap.horizon=0.05")
"""Where the whole catalogue, narrow intervals and long predictions would only take time."""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A folder with a person's platform file in it."""
    (tmp_path / "conf" / "platform").mkdir(parents=True)
    (tmp_path / "conf" / "platform" / "axis.yaml").write_text(yaml.safe_dump(PLATFORM))
    return tmp_path


def _raw(runs: int = 6) -> Recording:
    clean = joint_recording(Plant(friction=0.3), runs=runs)
    return Recording(clean.frame, "joint", clean.units, source="a bench")


def _arguments(folder: Path, recording: Path, *more: str) -> list[str]:
    return [
        "--config-dir",
        str(folder / "conf"),
        "platform=axis",
        f"recording={recording}",
        f"output={folder / 'out'}",
        "tracking.enabled=false",
        *more,
    ]


def _ends(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as ended:
        main(diagnose, arguments)
    return int(ended.value.code or 0)


def _refused(folder: Path, recording: Path, capsys: pytest.CaptureFixture[str], *more: str) -> str:
    """Run a diagnosis that must end with one line and leave nothing; return the line."""
    assert _ends(_arguments(folder, recording, *more)) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert "Traceback" not in printed.err
    assert not (folder / "out").exists()
    assert not [path for path in folder.iterdir() if path.name.startswith((".out", "out"))]
    return printed.err


@pytest.mark.slow
def test_from_a_parquet_file_in_another_folder(own):
    write_recording(_raw(), own / "bench.parquet")
    elsewhere = own / "elsewhere"
    elsewhere.mkdir()
    program = str(Path(sys.executable).parent / "simgap")
    arguments = [
        "diagnose", "platform=axis", "recording=../bench.parquet", "output=found",
        f"tracking.uri=sqlite:///{own}/runs.db", "--config-dir", "../conf",
    ]  # fmt: skip
    done = subprocess.run(
        [program, *arguments], cwd=elsewhere, capture_output=True, text=True, check=False, env=os.environ
    )
    assert done.returncode == 0
    assert all(line.startswith("warning: ") for line in done.stderr.splitlines())
    assert "verdict: missing_physics" in done.stdout
    assert "coulomb_friction" in done.stdout
    assert done.stdout.splitlines()[-1] == "found/report.html"
    document = read_diagnosis(elsewhere / "found" / "diagnosis.json", "joint")
    assert [effect["name"] for effect in document["effects"]] == ["coulomb_friction"]
    assert document["effects"][0]["parameters"]["level"]["value"] == pytest.approx(0.3, rel=0.02)
    page = (elsewhere / "found" / "report.html").read_text(encoding="utf-8")
    assert "The simulator leaves out Coulomb friction." in page
    assert "most probable explanations that were tried" in page
    assert "was ended before" not in page
    assert 'simgap.load_simulator("found/simulator")' in html.unescape(page)
    assert len(page.encode()) < 1.5e6
    (effect,) = read_simulator(elsewhere / "found" / "simulator").effects
    assert effect.effect.name == "coulomb_friction"
    assert [path.name for path in elsewhere.iterdir()] == ["found"]
    client, experiment = open_store(f"sqlite:///{own}/runs.db")
    runs = {run.info.run_name: run for run in client.search_runs([experiment])}
    assert set(runs) == {"bench", "diagnose"}
    for run in runs.values():
        assert run.data.tags["verdict"] == "missing_physics"
        assert run.data.tags["effects"].startswith("coulomb_friction ")
        assert run.data.metrics["gap_closed"] == document["fit"]["gap_closed"]


def test_a_search_that_its_budget_ends_is_said_on_the_page_and_in_the_terminal(own, monkeypatch, capsys):
    monkeypatch.chdir(own)
    write_recording(_raw(), own / "bench.parquet")
    assert _ends(_arguments(own, own / "bench.parquet", "gap.budget=1e-6")) == 0
    said = "The search was ended before it was complete; this is the best answer so far"
    assert capsys.readouterr().out.splitlines()[2].startswith(said)
    page = (own / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count(said) == 2  # below the verdict, and beside the probabilities


@pytest.mark.slow
def test_csv_and_parquet_give_the_same_diagnosis(own, monkeypatch):
    monkeypatch.chdir(own)
    raw = _raw()
    raw.frame.to_csv(own / "bench.csv", index=False)
    write_recording(raw, own / "bench.parquet")
    documents = []
    for file in ("bench.csv", "bench.parquet"):
        arguments = _arguments(own, own / file, *FEW)
        arguments[4] = f"output={own / file}.out"
        assert _ends(arguments) == 0
        documents.append(read_diagnosis(own / f"{file}.out" / "diagnosis.json", "joint"))
    first, second = documents
    assert first["effects"] == second["effects"]
    assert first["fit"] == second["fit"]


def test_one_run_is_diagnosed_with_a_warning(own, monkeypatch, capsys):
    monkeypatch.chdir(own)
    write_recording(_raw(runs=1), own / "bench.parquet")
    assert _ends(_arguments(own, own / "bench.parquet", *FEW)) == 0
    document = read_diagnosis(own / "out" / "diagnosis.json", "joint")
    assert document["fit"]["gap_closed"] is None
    errors = capsys.readouterr().err.splitlines()
    assert all("warning: " in line for line in errors)
    assert any("held out" in line for line in errors)
    assert [path.name for path in (own / "out").iterdir() if path.suffix == ".html"] == ["report.html"]


def test_hopeless_files_are_refused_in_one_line(own, monkeypatch, capsys):
    monkeypatch.chdir(own)
    (own / "empty.parquet").touch()
    assert "empty.parquet" in _refused(own, own / "empty.parquet", capsys)
    assert "nowhere.csv" in _refused(own, own / "nowhere.csv", capsys)
    frame = _raw(runs=1).frame
    frame.drop(columns="position").to_csv(own / "lacking.csv", index=False)
    assert "position" in _refused(own, own / "lacking.csv", capsys)
    backwards = frame.copy()
    backwards.loc[700, "t"] = 0.1
    backwards.to_csv(own / "backwards.csv", index=False)
    line = _refused(own, own / "backwards.csv", capsys)
    assert "run_0" in line
    assert "701" in line


def test_what_does_not_fit_together_is_refused_in_one_line(own, monkeypatch, capsys):
    monkeypatch.chdir(own)
    write_recording(_raw(), own / "bench.parquet")
    line = _refused(own, own / "bench.parquet", capsys, "gap.effects=[coulomb_fricton]")
    assert "did you mean 'coulomb_friction'?" in line
    line = _refused(own, own / "bench.parquet", capsys, "platform=racer")
    assert "joint" in line
    assert "quadrotor" in line
    assert "least_share" in _refused(own, own / "bench.parquet", capsys, "gap.least_sahre=1e-3")
    (own / "conf/platform/axis.yaml").write_text(yaml.safe_dump(PLATFORM | {"inertia": -1.0}))
    assert "inertia" in _refused(own, own / "bench.parquet", capsys)


def test_an_output_that_cannot_be_written_is_refused(own, monkeypatch, capsys):
    monkeypatch.chdir(own)
    write_recording(_raw(), own / "bench.parquet")
    (own / "out").write_text("a file where a folder should be")
    arguments = _arguments(own, own / "bench.parquet")
    arguments[4] = f"output={own / 'out' / 'inside'}"
    assert _ends(arguments) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert "out" in line
    assert (own / "out").read_text() == "a file where a folder should be"


def test_a_finished_diagnosis_outlives_a_failed_one(own, monkeypatch):
    monkeypatch.chdir(own)
    write_recording(_raw(), own / "bench.parquet")
    assert _ends(_arguments(own, own / "bench.parquet", *FEW)) == 0
    kept = (own / "out" / "diagnosis.json").read_bytes()
    assert _ends(_arguments(own, own / "bench.parquet", "gap.effects=[no_such_thing]")) == 2
    assert (own / "out" / "diagnosis.json").read_bytes() == kept
    assert json.loads(kept)["verdict"] == "missing_physics"


def test_the_api_finds_what_the_command_finds(own, monkeypatch):
    monkeypatch.chdir(own)
    write_recording(_raw(), own / "bench.parquet")
    assert _ends(_arguments(own, own / "bench.parquet", "gap.effects=[coulomb_friction]", "gap.folds=4")) == 0
    settings = {"gap": {"effects": ["coulomb_friction"], "folds": 4}}
    answer = simgap.diagnose("bench.parquet", own / "conf/platform/axis.yaml", settings=settings)
    answer.save("answer")
    for path in (own / "out").rglob("*"):
        if path.is_file() and path.name not in (".simgap", "metrics.json", "report.html"):
            assert path.read_bytes() == (own / "answer" / path.relative_to(own / "out")).read_bytes(), path
