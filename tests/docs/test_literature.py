"""The page of the literature names files and sections that are there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "literature.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if line.startswith("| ") and not line.startswith("| system")
]


@pytest.mark.parametrize("path", sorted(set(re.findall(r"`((?:pipeline|stages|conf)/[^`]+)`", PAGE))))
def test_a_file_of_the_page_is_there(path):
    assert (ROOT / path).exists()


def test_a_section_that_shows_a_system_is_on_the_page_of_results():
    results = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    sections = {line.removeprefix("## ") for line in results.splitlines() if line.startswith("## ")}
    assert {row[2] for row in ROWS} <= sections | {"–", "the same", "[Effects](effects.md)"}


def test_every_system_says_how_it_stands():
    assert all(re.match(r"(done|differs|open)\b", row[3]) for row in ROWS)
    assert all(len(row) == 4 for row in ROWS)


def test_what_is_done_or_differs_has_a_file():
    assert all(row[1] != "–" for row in ROWS if not row[3].startswith("open"))
