"""Sweeps that were run, written into the documentation by a command."""

from dataclasses import replace
from pathlib import Path

import pytest

from simgap.comparison.settings import Results
from simgap.stages.results import main
from tests.pipeline.comparison.sweeps import lengths


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("docs").mkdir()


def ran(name: str, title: str | None) -> Path:
    folder = Path("artifacts/nanodrone/sweeps") / name
    (folder / "comparison").mkdir(parents=True)
    replace(lengths(), name=name, results=Results(title)).write(folder / "comparison")
    return folder


def ended(*arguments: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main([*arguments, "--docs", "docs"])
    return int(caught.value.code or 0)


def test_all_sweeps_that_have_a_title_are_written(capsys):
    ran("lengths", "Sequence lengths")
    ran("train", None)
    assert ended() == 0
    assert capsys.readouterr().out == "results: wrote lengths into docs/results.md\n"
    assert "## Sequence lengths" in Path("docs/results.md").read_text()


def test_a_named_sweep_is_written_alone(capsys):
    ran("lengths", "Sequence lengths")
    assert ended(str(ran("train", None))) == 0
    page = Path("docs/results.md").read_text()
    assert "## train" in page
    assert "Sequence lengths" not in page


def test_where_nothing_was_run_that_is_said_in_one_line(capsys):
    assert ended() == 2
    assert capsys.readouterr().err == (
        "simgap results: artifacts/*/sweeps/*: there is no sweep that has a title; run one: a preset of"
        " conf/experiment opens with its command\n"
    )
    assert ended("absent") == 2
    assert "absent/comparison/comparison.json: cannot be read" in capsys.readouterr().err
    assert not Path("docs/results.md").exists()
