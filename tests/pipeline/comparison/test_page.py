from dataclasses import replace

import pytest

from simgap.comparison.comparison import FILE, Comparison
from simgap.comparison.figure import FIGURE, draw
from simgap.comparison.page import PAGE, tables_text, write_section
from simgap.comparison.settings import Results, TableOf
from simgap.errors import InputError
from tests.pipeline.comparison.sweeps import job, lengths, sweep


def written(folder, comparison):
    folder.mkdir(exist_ok=True)
    comparison.write(folder)
    draw(comparison, folder / FIGURE)
    return folder


def test_what_is_read_is_what_was_written(tmp_path):
    settings = Results(
        "Lengths",
        "All of them.",
        [TableOf("position/*")],
        TableOf("steps/*/mse", "MSE", True),
        {"model": "tcn"},
    )
    comparison = replace(lengths(), results=settings, failed=["model=x: no"])
    comparison.write(tmp_path)
    assert Comparison.read(tmp_path) == comparison


@pytest.mark.parametrize(
    "content", ["{", "{}", '{"schema": "other/1"}', '{"schema": "simgap.comparison/1"}', "[]"]
)
def test_what_is_no_comparison_is_refused_in_one_line(tmp_path, content):
    (tmp_path / FILE).write_text(content)
    with pytest.raises(InputError, match="is not a comparison") as caught:
        Comparison.read(tmp_path)
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="run the sweep to its end"):
        Comparison.read(tmp_path / "absent")


def test_tables_are_markdown():
    comparison = replace(
        lengths(), results=Results(tables=[TableOf("position/h1", "Error, m")], baseline={"model": "lstm"})
    )
    assert tables_text(replace(comparison, failed=["model=x: no"])).splitlines() == [
        "**Error, m**",
        "",
        "| model | model.sequence_length | position/h1 |",
        "| --- | --- | --: |",
        "| lstm | 5 | 2 ± 1.4 |",
        "| lstm | 10 | 2 ± 1.4 (+0%) |",
        "| tcn | 5 | 1 ± 0.71 (-50%) |",
        "| tcn | 10 | 1 ± 0.71 (-50%) |",
        "| persistence |  | 8 |",
        "",
        "Left out: model=x: no",
    ]


def test_where_only_seeds_were_swept_there_is_one_row():
    text = tables_text(sweep(job(1.0, 0), job(3.0, 1), results={"tables": [TableOf("position/h1")]}))
    assert text.splitlines()[-1] == "| as configured | 2 ± 1.4 |"


def test_what_rounding_leaves_is_no_spread():
    thirds = [job(error, seed) for seed, error in enumerate((0.1, 0.1, 0.1))]
    text = tables_text(sweep(*thirds, results={"tables": [TableOf("position/h1")]}))
    assert text.splitlines()[-1] == "| as configured | 0.1 ± 0 |"


def test_a_section_is_replaced_and_the_others_stay(tmp_path):
    docs = tmp_path / "docs"
    docs.mkdir()
    one, other = (
        replace(lengths(), name=name, results=Results(f"Title {name}", "A sentence."))
        for name in ("one", "other")
    )
    for comparison in (one, other):
        write_section(written(tmp_path / comparison.name, comparison), docs)
    before = (docs / PAGE).read_text()
    changed = replace(one, jobs=one.jobs[:4], results=Results("Anew"))
    write_section(written(tmp_path / "one", changed), docs)
    after = (docs / PAGE).read_text()
    assert before.index("## Title one") < before.index("## Title other")
    assert after.index("## Anew") < after.index("## Title other")
    assert "## Title one" not in after
    assert after.split("<!-- sweep: other -->")[1] == before.split("<!-- sweep: other -->")[1]
    assert "`simgap train -m …`\n\nMeasured on 2 cores. The 4 jobs took 2.0 minutes in sequence" in after
    assert (docs / "images" / "results_one.svg").exists()
    assert "](images/results_one.svg)" in after
    write_section(tmp_path / "one", docs)
    assert (docs / PAGE).read_text() == after


def test_a_picture_that_a_sweep_no_longer_has_goes(tmp_path):
    docs = tmp_path / "docs"
    docs.mkdir()
    sweep_folder = written(tmp_path / "imagined", lengths())
    write_section(sweep_folder, docs)
    (sweep_folder / FIGURE).unlink()
    write_section(written(sweep_folder, replace(lengths(), jobs=lengths().jobs[:2])), docs)
    assert "![" not in (docs / PAGE).read_text()
    assert list((docs / "images").iterdir()) == []


def test_numbers_are_written_as_people_read_them():
    text = tables_text(sweep(job(73248.0, 0), results={"tables": [TableOf("position/h1")]}))
    assert "73,248" in text.splitlines()[-1]


def test_a_table_opens_on_what_was_swept_with_units():
    units = {"model.sequence_length": "samples", "position/*": "m"}
    text = tables_text(replace(lengths(), results=Results(units=units)))
    assert "| model | model.sequence_length (samples) | h1 (m) | h10 (m) |" in text
