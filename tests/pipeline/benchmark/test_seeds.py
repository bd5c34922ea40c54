"""The table of seeds, and its page."""

import re

from simgap.artifacts import PROJECT_ROOT
from simgap.benchmark.seeds import read_seeds, seeds_text

COUNTS = ["clear", "faint", "pairs", "nulls", "decoys", "hidden", "mixed"]


def test_every_row_says_what_its_seeds_were_used_for():
    seeds = read_seeds()
    assert set(seeds["use"]) == {"calibration", "development", "scored"}
    assert (seeds["seeds"] != "").all()
    assert not seeds.duplicated(["seeds", "use", "kinds"]).any()


def test_counts_are_of_a_total_and_scored_runs_have_them():
    seeds = read_seeds().set_index("use")
    for cell in seeds[COUNTS].to_numpy().ravel():
        if cell:
            counted, total = map(int, re.fullmatch(r"(\d+)/(\d+)", cell).groups())
            assert 0 <= counted <= total
    assert (seeds.loc["scored", ["clear", "faint", "pairs", "nulls"]] != "").all(axis=None)
    assert (seeds.loc[["calibration", "development"], COUNTS] == "").all(axis=None)


def test_the_page_has_a_line_for_each_row():
    seeds = read_seeds()
    lines = [line for line in seeds_text(seeds).splitlines() if line.startswith("| ")]
    assert len(lines) == len(seeds) + 4  # two heads of two lines
    assert {line.count("|") for line in lines} == {6, len(seeds.columns)}


def test_the_documentation_shows_the_table_as_it_is():
    assert seeds_text(read_seeds()) in (PROJECT_ROOT / "docs" / "proof.md").read_text(encoding="utf-8")
