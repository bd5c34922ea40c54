"""Sweeps that were run, written into the documentation by a command."""

from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from simgap.artifacts.project import CONFIGURATION, PROJECT_ROOT
from simgap.comparison.settings import Results
from simgap.stages.results import main
from tests.pipeline.comparison.sweeps import lengths

PRESETS = {
    path.stem: yaml.safe_load(path.read_text(encoding="utf-8"))
    for path in (CONFIGURATION / "experiment").glob("*.yaml")
}
SHOWN = sorted(name for name, preset in PRESETS.items() if preset.get("results", {}).get("title"))


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


@pytest.mark.parametrize("name", SHOWN)
def test_the_page_of_the_documentation_has_the_words_of_the_preset(name):
    results = PRESETS[name]["results"]
    page = (PROJECT_ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    section = page.partition(f"<!-- sweep: {name} -->\n")[2].partition("<!-- sweep:")[0]
    command, *_ = section.partition("\n`simgap ")[2].partition("`")
    assert section.startswith(f"## {results['title']}\n\n{results.get('text', '')}".rstrip())
    assert f"+experiment={name}" in command.split()
    for table in results.get("tables", []):
        assert f"\n**{table['title']}**\n" in section


def test_every_section_of_the_page_belongs_to_a_preset():
    page = (PROJECT_ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    assert sorted(part.partition(" -->")[0] for part in page.split("<!-- sweep: ")[1:]) == SHOWN
